//! Dwell-time stiction: after a rest of length t_d, `+ a (1 - exp(-(t_d/t_0)^m)) exp(-s/s_0)`, with
//! s the sliding distance since the rest.
//!
//! Contacts grow during a rest and are sheared off by sliding.
//!
//! Source: Kato et al. (1972); Cohn (1998), section 2.1.5.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Static friction that rises with the length of a rest.
#[derive(Clone, Copy, Debug)]
pub struct DwellStiction<T> {
    height: T,
    inverse_time_1_s: T,
    exponent: T,
    inverse_distance_1_m: T,
}

/// Length of the last rest, and the sliding distance since that rest.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    rest_s: T,
    slid_m: T,
    resting: bool,
}

described! {
    named_effect DwellStiction = Info::new::<T, Self>("dwell_stiction", Stage::Contact)
        .summary("static friction that grows during a rest")
        .equation("f -> f + a (1 - exp(-(t_d/t_0)^m)) exp(-s/s_0) sgn(v)")
        .source("Kato et al. 1972; Cohn 1998, section 2.1.5")
        .limits("a rest has a speed of exactly zero; creep during a rest is not included");
    a = "a", "-", "friction coefficient added after a very long rest", [0.0, 1e3], [0.08] null(0.0);
    t_0_s = "t_0_s", "s", "rest duration for 63 % of it", [1e-3, 1e6], [3.0] .log();
    m = "m", "-", "exponent of the growth", [0.05, 5.0], [0.7] .log();
    s_0 = "s_0", "m", "sliding distance in which it decays to 1/e",
        [1e-6, 1e2], [2e-3, 2e-2] .log();
}

impl<T: Real> DwellStiction<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            height: p.a,
            inverse_time_1_s: T::ONE / p.t_0_s,
            exponent: p.m,
            inverse_distance_1_m: T::ONE / p.s_0,
        }
    }
}

impl<T: Real> Effect<T> for DwellStiction<T> {
    type State = State<T>;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            rest_s: T::ZERO,
            slid_m: T::ZERO,
            resting: false,
        }
    }

    #[inline(always)]
    fn contact(
        &self,
        state: &mut State<T>,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        if from.velocity_m_s == T::ZERO && to.velocity_m_s == T::ZERO {
            if !state.resting {
                state.rest_s = T::ZERO;
                state.slid_m = T::ZERO;
                state.resting = true;
            }
            state.rest_s += dt_s;
        } else {
            state.resting = false;
            state.slid_m += from.distance_m(to, dt_s);
        }
        if state.rest_s.value() <= 0.0 {
            return;
        }
        let grown = T::ONE - (-(state.rest_s * self.inverse_time_1_s).powf(self.exponent)).exp();
        let left = (-(state.slid_m * self.inverse_distance_1_m)).exp();
        sliding.jump += self.height * grown * left;
    }
}
