//! Equations of motion of the film, (3.18) and (3.19) of Cohn (1998), in `x = eps cos(phi)`, `y =
//! eps sin(phi)`, with the film integrals combined:
//!
//! ```text
//! J12/J11         = -(4/pi) eps / sqrt(d),  d = 1 - eps^2
//! J22 - J12^2/J11 = d^(-5/2) [ pi/2 + (pi - 8/pi) eps^2 ]
//! ```
//!
//! The latency of a step is that of its longest sequence of dependent operations, so the two square
//! roots and the division are independent of each other. Because `sqrt(d)^2 = d`, the rotation has
//! no root. On x86-64 this order of operations is 1.9 times faster than that of the printed
//! equations.

use super::film_slopes;
use super::{Journal, Loaded};
use crate::film::{FOUR_OVER_PI, PI_LESS_8_OVER_PI};
use crate::real::Real;
use crate::stepper::System;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use nalgebra::Vector2;

/// Eccentricity ratio below which the journal is at the centre, where its direction is undefined.
const CENTRE: f64 = 1e-12;

/// Returns true if the equations hold without a limit, for a position with `e2 = x^2 + y^2` off the
/// centre and inside the bearing.
#[inline(always)]
pub(super) fn within<T: Real>(e2: T) -> bool {
    e2 <= T::EPS_LIMIT * T::EPS_LIMIT && e2 >= T::of(CENTRE * CENTRE)
}

/// Square `x^2 + y^2` of the eccentricity ratio at a position.
#[inline(always)]
pub(crate) fn square<T: Real>(xy: &Vector2<T>) -> T {
    xy.x * xy.x + xy.y * xy.y
}

/// Film equations as a system of two states with the input `|Ub|`.
///
/// The states are the displacement since the start of the step, because single precision resolves
/// it much better than the position.
pub(super) struct Film<'a, T> {
    pub(super) law: &'a Journal<T>,
    pub(super) loaded: &'a Loaded<T>,
    /// Values of `x` and `y` at the start of the step.
    pub(super) from: Vector2<T>,
    /// Value of `x^2 + y^2` at the start of the step.
    pub(super) from_e2: T,
}

impl<T: Real> System<T, 2> for Film<'_, T> {
    #[inline(always)]
    fn slope(&self, way: &Vector2<T>, ub: T) -> Vector2<T> {
        let xy = self.from + way;
        self.anywhere(xy, square(&xy), ub)
    }

    #[inline(always)]
    fn slope_at_start(&self, _way: &Vector2<T>, ub: T) -> Vector2<T> {
        self.anywhere(self.from, self.from_e2, ub)
    }
}

impl<T: Real> Film<'_, T> {
    #[inline(always)]
    fn anywhere(&self, xy: Vector2<T>, e2: T, ub: T) -> Vector2<T> {
        let outside = !within(e2);
        if outside && !T::SIDE_BY_SIDE {
            return self.edge(xy.x, xy.y, e2, ub);
        }
        let ub = if outside { T::of(f64::NAN) } else { ub };
        self.inside(xy, e2, ub)
    }

    /// Time derivative of the position outside the bearing and at the centre.
    ///
    /// Stages of a coarse step may be outside the bearing. They are evaluated at the largest
    /// eccentricity in the same direction. The centre is evaluated at a small distance from it.
    #[cold]
    #[inline(never)]
    fn edge(&self, x: T, y: T, e2: T, ub: T) -> Vector2<T> {
        let limit = T::EPS_LIMIT * T::EPS_LIMIT;
        if e2 > limit {
            let shrink = T::EPS_LIMIT / e2.sqrt();
            self.inside(Vector2::new(x * shrink, y * shrink), limit, ub)
        } else {
            let near = T::of(CENTRE);
            self.inside(Vector2::new(near, T::ZERO), near * near, ub)
        }
    }

    #[inline(always)]
    fn inside(&self, xy: Vector2<T>, e2: T, ub: T) -> Vector2<T> {
        let asperities = self.law.asperities(self.loaded);
        slope(self.loaded.load_number, xy, e2, &asperities, ub)
    }
}

/// Model of the asperities, which carry a part of the load in contact.
#[derive(Clone, Copy)]
pub(super) struct Asperities<T> {
    pub(super) k0: T,
    pub(super) eps_tr: T,
    /// True if the asperities separate below eps_tr. False if the parabola continues there, for a
    /// step that may extend beyond eps_tr.
    pub(super) part: bool,
}

impl<T: Real> Asperities<T> {
    /// Depth of contact `e - eps_tr` at an eccentricity ratio, zero without contact.
    #[inline(always)]
    pub(super) fn touch(&self, e: T) -> T {
        e - self.eps_tr
    }

    /// Asperity load `W = K0 (eps - eps_tr)^2`, zero below eps_tr.
    #[inline(always)]
    pub(super) fn load(&self, e: T) -> T {
        let touch = self.touch(e);
        let load = self.k0 * touch * touch;
        if touch > T::ZERO || !self.part {
            load
        } else {
            T::ZERO
        }
    }

    /// Returns the asperity model without derivatives.
    #[inline(always)]
    pub(super) fn plain(&self) -> Asperities<f64> {
        Asperities {
            k0: self.k0.value(),
            eps_tr: self.eps_tr.value(),
            part: self.part,
        }
    }
}

/// Terms at a position that several functions share: two square roots and one division.
#[derive(Clone, Copy)]
pub(super) struct Gap<T> {
    /// Value of `eps^2`.
    pub(super) e2: T,
    /// Value of `1 - eps^2`.
    pub(super) d: T,
    /// Eccentricity ratio.
    pub(super) e: T,
    /// Value of `sqrt(1 - eps^2)`.
    pub(super) root: T,
    /// Value of `(J22 - J12^2/J11) d^(5/2)`.
    pub(super) determinant: T,
    /// Value of `1 / (eps^2 d determinant)`, infinite at the centre.
    pub(super) inverse: T,
}

impl<T: Real> Gap<T> {
    #[inline(always)]
    pub(super) fn at(e2: T) -> Self {
        let d = T::ONE - e2;
        let (e, root) = (e2.sqrt(), d.sqrt());
        let determinant = T::of(FRAC_PI_2) + e2 * T::of(PI_LESS_8_OVER_PI);
        let inverse = T::ONE / (e2 * (d * determinant));
        Self {
            e2,
            d,
            e,
            root,
            determinant,
            inverse,
        }
    }

    /// Value of `1 / sqrt(1 - eps^2)`.
    #[inline(always)]
    pub(super) fn inverse_root(&self) -> T {
        let inverse = self.root * (self.e2 * self.determinant * self.inverse);
        if self.e2 < T::of(CENTRE * CENTRE) {
            T::ONE
        } else {
            inverse
        }
    }
}

/// Time derivative of the position at `e2 = x^2 + y^2`, which must not be close to 0 or 1.
#[inline(always)]
pub(super) fn slope<T: Real>(
    fb: T,
    xy: Vector2<T>,
    e2: T,
    asperities: &Asperities<T>,
    ub: T,
) -> Vector2<T> {
    if T::HAS_SLOPES {
        film_slopes::motion(fb, xy, e2.value(), asperities, ub)
    } else {
        let gap = Gap::at(e2);
        plain(&gap, fb, xy, asperities.load(gap.e), ub)
    }
}

/// Time derivative of the position in which every operation carries the derivatives of its
/// arguments.
#[inline(always)]
pub(super) fn plain<T: Real>(gap: &Gap<T>, fb: T, xy: Vector2<T>, load: T, ub: T) -> Vector2<T> {
    let (x, y) = (xy.x, xy.y);
    let &Gap {
        e2,
        d,
        e,
        root,
        determinant,
        inverse,
    } = gap;
    let stiff = d * d * d * inverse;
    // Fb cos(phi), the asperity load, Fb (J12/J11) sin(phi).
    let along = (fb * x) * d * determinant * inverse * e;
    let across = (fb * T::of(FOUR_OVER_PI)) * y * e2 * determinant * inverse * root;
    let push = along - load - across;
    // eps'/eps, and phi' in two parts: from the radial motion and from the rotation of the oil.
    let radial = push * (stiff * e * root);
    let swing = push * (stiff * e2 * T::of(FOUR_OVER_PI));
    let lag = (fb * T::of(FRAC_2_PI)) * y * d * d * determinant * inverse * root - T::of(0.5) * ub;
    let turn = swing - lag;
    Vector2::new(radial * x - turn * y, radial * y + turn * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::journal::Parameters;
    use crate::{Bearing, Clock};

    fn near(got: Vector2<f64>, wanted: Vector2<f64>) {
        let size = wanted.amax().max(1e-9);
        assert!((got - wanted).amax() <= 1e-9 * size, "{got} {wanted}");
    }

    /// The load moves a journal at the centre straight down with `eps' = (2/pi) Fb`. A stage
    /// outside the bearing has the time derivative at the edge in its direction.
    #[test]
    fn film_slope_is_defined_at_the_centre_and_held_beyond_the_edge() {
        let law = Journal::<f64>::new(
            &Bearing::THESIS,
            104.0,
            &Parameters::TABLE_4_2,
            Clock::Journal,
        )
        .expect("valid");
        let loaded = law.nominal();
        let at = |from: Vector2<f64>| Film {
            law: &law,
            loaded: &loaded,
            from,
            from_e2: square(&from),
        };
        let still = Vector2::zeros();
        for ub in [0.0, 0.7, 3.0] {
            let wanted = Vector2::new(FRAC_2_PI * loaded.load_number, 0.0);
            near(at(still).slope_at_start(&still, ub), wanted);
            let off = Vector2::new(0.3, -0.4);
            near(at(off).slope(&-off, ub), wanted);
            let limit = <f64 as Real>::EPS_LIMIT * (1.0 - 1e-15);
            for direction in [[1.0, 0.0], [0.6, 0.8], [-0.8, 0.6]] {
                let direction = Vector2::from(direction);
                let edge = at(direction * limit).slope(&still, ub);
                for beyond in [1.0, 1.5, 4.0] {
                    let got = at(direction * beyond).slope(&still, ub);
                    assert!((got - edge).norm() <= 1e-3 * edge.norm(), "{got} {edge}");
                }
            }
        }
    }
}
