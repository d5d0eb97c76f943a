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

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Excess friction that decays with time.
#[derive(Clone, Copy, Debug)]
pub struct WarmUp<T> {
    excess: T,
    rate_1_s: T,
}

described! {
    named_effect WarmUp = Info::new::<T, Self>("warm_up", Stage::Contact)
        .summary("warm-up: each run starts cold, and all friction falls with time")
        .equation("f -> f (1 + a exp(-t/tau)), t since the start of the run")
        .source("Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits("equally cold at the start of each run; one lumped temperature, small changes")
        .needs(&[Need::NoFilm]);
    a = "a", "-", "relative excess of the cold drive", [-0.95, 10.0], [0.2] null(0.0);
    tau_s = "tau_s", "s", "time in which the excess decays to 1/e",
        [0.1, 1e5], [10.0, 60.0] .log();
}

impl<T: Real> WarmUp<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            excess: p.a,
            rate_1_s: T::ONE / p.tau_s,
        }
    }
}

impl<T: Real> Effect<T> for WarmUp<T> {
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
        let factor = T::ONE + self.excess * (-(journal.time_s * self.rate_1_s)).exp();
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
