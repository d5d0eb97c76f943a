//! The equations of motion of the film, (3.18) and (3.19), in `x = eps cos(phi)`,
//! `y = eps sin(phi)`, with the film integrals folded together:
//!
//! ```text
//! J12/J11         = -(4/pi) eps / sqrt(d),  d = 1 - eps^2
//! J22 - J12^2/J11 = d^(-5/2) [ pi/2 + (pi - 8/pi) eps^2 ]
//! ```

use super::{Journal, Loaded};
use crate::film::{FOUR_OVER_PI, PI_LESS_8_OVER_PI};
use crate::real::Real;
use crate::stepper::System;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// The film as a system of two states driven by `|Ub|`: its way from where a step began,
/// which single precision resolves far better than the place itself.
pub(super) struct Film<'a, T> {
    pub(super) law: &'a Journal<T>,
    pub(super) loaded: &'a Loaded<T>,
    /// `x` and `y` where the step began.
    pub(super) from: [T; 2],
}

impl<T: Real> System<T, 2> for Film<'_, T> {
    #[inline]
    fn slope(&self, way: &[T; 2], ub: T) -> [T; 2] {
        let (x, y) = (self.from[0] + way[0], self.from[1] + way[1]);
        let distance = (x * x + y * y).sqrt();
        // Stages of a coarse step may look outside the bearing: show them the limit, in
        // their own direction.
        let e = distance.min(T::EPS_LIMIT);
        let (c, s) = if distance > T::of(1e-12) {
            let inverse = T::ONE / distance;
            (x * inverse, y * inverse)
        } else {
            (T::ONE, T::ZERO)
        };
        let d = (T::ONE - e) * (T::ONE + e);
        let root = d.sqrt();
        let fb = self.loaded.load_number;
        let ratio = T::of(FOUR_OVER_PI) * e / root;
        let push = fb * (c - ratio * s) - self.law.asperity_load(e, self.loaded.eps_tr);
        let determinant = T::of(FRAC_PI_2) + e * e * T::of(PI_LESS_8_OVER_PI);
        let d52 = d * d * root;
        let radial = push * d52 / determinant;
        let tangential =
            T::of(0.5) * e * ub + ratio * radial - fb * T::of(FRAC_2_PI) * s * d * root;
        [radial * c - tangential * s, radial * s + tangential * c]
    }
}
