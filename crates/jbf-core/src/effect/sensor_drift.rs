//! Sensor drift `+ d t`, such as the charge leakage of a piezo cell or the warming of a bridge.
//!
//! Source: charge amplifiers of piezo-electric load cells (Gautschi 2002).

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::described::described;
use crate::motion::Motion;
use crate::real::Real;

/// Drift of the zero of a load cell at a constant rate.
#[derive(Clone, Copy, Debug)]
pub struct SensorDrift<T> {
    slope_n_s: T,
}

described! {
    named_effect SensorDrift = Info::new::<T, Self>("sensor_drift", Stage::Instrument)
        .summary("zero of the load cell drifts linearly during a run")
        .equation("r -> r + d t, t since the start of the run")
        .source("Gautschi 2002 (charge leak of piezo cells)")
        .limits(
            "linear, from zero in each run; the leakage of a piezo cell saturates after \
                 its time constant",
        );
    d = "d", "N/s", "change of the reading per second", [-1e4, 1e4], [0.005] null(0.0) .signed();
}

impl<T: Real> SensorDrift<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { slope_n_s: p.d }
    }
}

impl<T: Real> Effect<T> for SensorDrift<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn reading(&self, _state: &mut (), signal: &mut Signal<T>, time_s: T, dt_s: T) {
        let begin_n = signal.begin_n + self.slope_n_s * (time_s - dt_s);
        *signal = signal.shifted(self.slope_n_s * time_s);
        signal.begin_n = begin_n;
    }
}
