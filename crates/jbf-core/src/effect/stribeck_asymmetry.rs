//! Direction-dependent Stribeck peak: `+ c exp(-(|v|/v_s)^n)`.
//!
//! Lips, wipers and skewed rollers draw in a film in one direction and scrape it off in the other.
//! The friction of the two directions differs at low speed only. `c` is half the difference of the
//! peaks in positive and negative motion.
//!
//! Source: Stribeck's curve in the form of Bo & Pavelescu (1982), with one height per direction;
//! Armstrong-Helouvry et al. (1994), who list direction-dependent friction.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Stribeck peak that differs between the two directions.
#[derive(Clone, Copy, Debug)]
pub struct StribeckAsymmetry<T> {
    height_n: T,
    inverse_speed_s_m: T,
    exponent: T,
}

described! {
    named_effect StribeckAsymmetry = Info::new::<T, Self>("stribeck_asymmetry", Stage::Contact)
        .summary("Stribeck peak at low speed that is larger in one direction")
        .equation("F -> F + c exp(-(|v|/v_s)^n)")
        .source("Bo & Pavelescu 1982; Armstrong-Helouvry et al. 1994")
        .limits("no memory, no dwell; the dry level is never below zero in either direction")
        .needs(&[Need::NoFilm]);
    c = "c", "N", "half of the difference of the peaks between the directions",
        [-1e7, 1e7], [0.1] null(0.0) .signed();
    v_s = "v_s", "m/s", "speed at which it has fallen to 1/e",
        [1e-7, 1e2], [0.01, 0.04] .log();
    n = "n", "-", "exponent of the decrease", [0.2, 8.0], [1.5] .log();
}

impl<T: Real> StribeckAsymmetry<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            height_n: p.c,
            inverse_speed_s_m: T::ONE / p.v_s,
            exponent: p.n,
        }
    }
}

impl<T: Real> Effect<T> for StribeckAsymmetry<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn contact(
        &self,
        _state: &mut (),
        _from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        _dt_s: T,
    ) {
        let speed = journal.velocity_m_s.abs() * self.inverse_speed_s_m;
        let higher = self.height_n * (-speed.powf(self.exponent)).exp();
        sliding.jump = (sliding.jump + higher * journal.way()).max(T::ZERO);
    }
}
