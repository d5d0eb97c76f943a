//! Dwell-time stiction: after a rest of length t_d, `+ a (1 - exp(-(t_d/t_0)^m)) exp(-s/s_0)`, with
//! s the sliding distance since the rest.
//!
//! Contacts grow during a rest and are sheared off by sliding.
//!
//! Source: Kato et al. (1972); Cohn (1998), section 2.1.5.

use super::{Contact, Effect, Info, Parameter, Rig, Stage};
use crate::error::ParameterError;
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

impl<T: Real> Effect<T> for DwellStiction<T> {
    const INFO: Info = Info::new("dwell_stiction", Stage::Contact)
        .summary("static friction that grows during a rest")
        .equation("f -> f + a (1 - exp(-(t_d/t_0)^m)) exp(-s/s_0) sgn(v)")
        .source("Kato et al. 1972; Cohn 1998, section 2.1.5")
        .limits("a rest has a speed of exactly zero; creep during a rest is not included")
        .parameters(&[
            Parameter::new(
                "a",
                "-",
                "friction coefficient added after a very long rest",
                [0.0, 1e3],
                &[0.08],
            )
            .null(0.0),
            Parameter::new(
                "t_0_s",
                "s",
                "rest duration for 63 % of it",
                [1e-3, 1e6],
                &[3.0],
            )
            .log(),
            Parameter::new("m", "-", "exponent of the growth", [0.05, 5.0], &[0.7]).log(),
            Parameter::new(
                "s_0",
                "m",
                "sliding distance in which it decays to 1/e",
                [1e-6, 1e2],
                &[2e-3, 2e-2],
            )
            .log(),
        ]);
    type State = State<T>;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            height: parameters[0],
            inverse_time_1_s: T::ONE / parameters[1],
            exponent: parameters[2],
            inverse_distance_1_m: T::ONE / parameters[3],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            rest_s: T::ZERO,
            slid_m: T::ZERO,
            resting: false,
        }
    }
}

impl<T: Real> Contact<T> for DwellStiction<T> {
    #[inline(always)]
    fn apply(&self, state: &State<T>, _journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        if state.rest_s.value() <= 0.0 {
            return;
        }
        let grown = T::ONE - (-(state.rest_s * self.inverse_time_1_s).powf(self.exponent)).exp();
        let left = (-(state.slid_m * self.inverse_distance_1_m)).exp();
        sliding.jump += self.height * grown * left;
    }

    #[inline(always)]
    fn step(&self, state: &mut State<T>, from: &JournalMotion<T>, to: &JournalMotion<T>, dt_s: T) {
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
    }
}
