//! Stribeck excess `+ a exp(-(|v|/v_s)^n)`: additional friction at low speed by boundary
//! lubrication, which the asperity model does not include.
//!
//! Source: Stribeck's curve in the exponential form of Tustin (n = 1), Bo & Pavelescu (0.5 to 1)
//! and Armstrong-Helouvry (2); Cohn (1998), sections 2.1.2 and 2.2.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Friction at low speed in addition to that of the law.
#[derive(Clone, Copy, Debug)]
pub struct StribeckExcess<T> {
    height: T,
    inverse_speed_s_m: T,
    exponent: T,
}

described! {
    named_effect StribeckExcess = Info::new::<T, Self>("stribeck_excess", Stage::Contact)
        .summary("boundary friction at low speed in addition to that of the law")
        .equation("f -> f + a exp(-(|v|/v_s)^n) sgn(v)")
        .source("Tustin 1947; Bo and Pavelescu 1982; Armstrong-Helouvry 1991; Cohn 1998, 2.1.2")
        .limits("no memory (a film that lags behind the speed is film_memory); no dwell");
    a = "a", "-", "friction coefficient added at rest",
        [0.0, 1e3], [0.05] null(0.0);
    v_s = "v_s", "m/s", "speed at which it has fallen to 1/e",
        [1e-7, 1e2], [0.01, 0.04] .log();
    n = "n", "-", "exponent of the decrease", [0.2, 8.0], [1.5] .log();
}

impl<T: Real> StribeckExcess<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            height: p.a,
            inverse_speed_s_m: T::ONE / p.v_s,
            exponent: p.n,
        }
    }
}

impl<T: Real> Effect<T> for StribeckExcess<T> {
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
        sliding.jump += self.height * (-speed.powf(self.exponent)).exp();
    }
}
