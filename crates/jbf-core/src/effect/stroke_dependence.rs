//! Dry friction that varies smoothly along the stroke, by a positive factor of the position.
//!
//! Examples are a screw with more preload in its middle, a guide that is not straight, and a rod
//! with local wear. The contact pressure, and with it the dry friction, varies slowly with the
//! position. Periodic variation is described by `pitch_ripple`.
//!
//! With `u` from -1 to 1 over the stroke, `s` is the sum of the first six waves whose slope
//! vanishes at both ends: `sin(k pi u/2)` for odd and `cos(k pi u/2)` for even `k`. Each wave has
//! zero mean over the stroke, and the waves are orthogonal to each other and to a constant.
//! Beyond the ends, friction is constant.
//!
//! The factor is `q = 1 + s` if `s >= -1/2`, and `q = 1/(4 |s|)` otherwise. It is positive and has a
//! continuous slope. With `1 + s` alone, dry friction could vanish at the ends of the stroke, which
//! lie beyond the travel of the fitted runs.
//!
//! A fit places the ends slightly beyond the travel of its runs, because friction may still vary at
//! the ends of a recording. The recorded travel then contains two and a half of the shortest waves.
//! Shorter variation is described by `pitch_ripple`.
//!
//! Source: Armstrong-Helouvry (1991), chapter 3, whose arm has a position-dependent friction in
//! each joint; Popovic & Goldenberg (1998), who model it by its Fourier series.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::f64::consts::FRAC_PI_2;

/// Dry friction that varies with the position along the stroke.
#[derive(Clone, Copy, Debug)]
pub struct StrokeDependence<T> {
    sizes: [T; 6],
    middle_m: T,
    inverse_half_1_m: T,
}

described! {
    named_effect StrokeDependence = Info::new::<T, Self>("stroke_dependence", Stage::Contact)
        .summary("dry friction that varies smoothly along the stroke")
        .equation(
            "F_dry -> q F_dry with q = 1 + s if s >= -1/2, otherwise 1/(4 |s|); s = sum of a_k w_k(u), \
             w_k = sin(k pi u/2) for k odd, cos(k pi u/2) for k even, u = (x - x_0)/h within -1 and 1",
        )
        .source("Armstrong-Helouvry 1991, chapter 3; Popovic & Goldenberg 1998")
        .limits(
            "variations over less than a fifth of the stroke are smoothed; a decrease by more than \
             half is compressed; constant beyond the ends; the position must be absolute or have \
             the same zero in every run",
        )
        .needs(&[Need::NoFilm, Need::Position]);
    a_1 = "a_1", "-", "half a wave: upper end higher than lower end", [-2.0, 2.0], [0.1] null(0.0) .signed();
    a_2 = "a_2", "-", "one wave: middle higher than both ends", [-2.0, 2.0], [0.1] null(0.0);
    a_3 = "a_3", "-", "one and a half waves", [-2.0, 2.0], [0.1] null(0.0) .signed();
    a_4 = "a_4", "-", "two waves: middle and ends higher than the quarters", [-2.0, 2.0], [0.1] null(0.0);
    a_5 = "a_5", "-", "two and a half waves", [-2.0, 2.0], [0.1] null(0.0) .signed();
    a_6 = "a_6", "-", "three waves", [-2.0, 2.0], [0.1] null(0.0);
    x_0 = "x_0", "m", "middle of the stroke",
        [-1e6, 1e6], [0.1] .signed();
    h = "h", "m", "half of the stroke", [1e-9, 1e6], [0.4] .log();
}

impl<T: Real> StrokeDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            sizes: [p.a_1, p.a_2, p.a_3, p.a_4, p.a_5, p.a_6],
            middle_m: p.x_0,
            inverse_half_1_m: T::ONE / p.h,
        }
    }
}

impl<T: Real> Effect<T> for StrokeDependence<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }

    #[inline(always)]
    fn contact(
        &self,
        radius_m: &mut T,
        _from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        _dt_s: T,
    ) {
        let u = (journal.angle_rad * *radius_m - self.middle_m) * self.inverse_half_1_m;
        let u = u.max(-T::ONE).min(T::ONE);
        // cos 2q to cos 6q from one sine.
        let sine = (u * T::of(FRAC_PI_2)).sin();
        let square = sine * sine;
        let whole = T::ONE - T::of(2.0) * square;
        let third = sine * (T::of(3.0) - T::of(4.0) * square);
        let twice = T::of(2.0) * whole * whole - T::ONE;
        let fifth = T::of(2.0) * whole * third - sine;
        let sixth = whole * (T::of(2.0) * twice - T::ONE);
        let waves = [sine, whole, third, twice, fifth, sixth];
        let mut linear = T::ONE;
        for (size, wave) in self.sizes.iter().zip(waves) {
            linear += *size * wave;
        }
        // 1 + s, or 1/2 times 1/2 divided by |s|: the term that is not used equals 1/2.
        let half = T::of(0.5);
        sliding.jump *= half.max(linear) * (half / (T::ONE - linear).max(half));
    }
}
