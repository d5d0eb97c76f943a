//! Warm-up: friction multiplied by `1 + a exp(-t/tau)`, with t the time since the start of the run.
//!
//! The motor, the bearings or the sun heat the grease and oil of a gearbox. Its friction falls with
//! time, in motion and at rest. Related effects:
//!
//! - `running_in` depends on the sliding distance and changes only the dry level.
//! - `thermal_thinning` describes a film that is heated only by its own friction.
//! - `sensor_drift` is a force that does not change sign with the motion.
//! - `dry_temperature_dependence` and `viscous_temperature_dependence` are more informative where a
//!   temperature was recorded.
//!
//! Source: Bittencourt & Gunnarsson (2012) and Simoni et al. (2019) on robot joints that warm up.
//! The temperature of one lumped body follows `exp(-t/tau)`. The change of friction is proportional
//! to it as long as it is small.

use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;

/// Excess friction that decays with time.
#[derive(Clone, Copy, Debug)]
pub struct WarmUp<T> {
    excess: T,
    rate_1_s: T,
}

impl<T: Real> Effect<T> for WarmUp<T> {
    const INFO: Info = Info::new("warm_up", Stage::Contact)
        .summary("warm-up: each run starts cold, and all friction falls with time")
        .equation("f -> f (1 + a exp(-t/tau)), t since the start of the run")
        .source("Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits("equally cold at the start of each run; one lumped temperature, small changes")
        .parameters(&[
            Parameter::new(
                "a",
                "-",
                "relative excess of the cold drive",
                [-0.95, 10.0],
                &[0.2],
            )
            .null(0.0),
            Parameter::new(
                "tau_s",
                "s",
                "time in which the excess decays to 1/e",
                [0.1, 1e5],
                &[10.0, 60.0],
            )
            .log()
            .start(Start::RunTime),
        ])
        .needs(&[Need::NoFilm]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            excess: parameters[0],
            rate_1_s: T::ONE / parameters[1],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for WarmUp<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        let factor = T::ONE + self.excess * (-(journal.time_s * self.rate_1_s)).exp();
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
