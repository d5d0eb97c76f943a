//! Sensor drift `+ d t`, such as the charge leakage of a piezo cell or the warming of a bridge.
//!
//! Source: charge amplifiers of piezo-electric load cells (Gautschi 2002).

use super::{Effect, Info, Instrument, Parameter, Rig, Signal, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::real::Real;

/// Drift of the zero of a load cell at a constant rate.
#[derive(Clone, Copy, Debug)]
pub struct SensorDrift<T> {
    slope_n_s: T,
}

impl<T: Real> Effect<T> for SensorDrift<T> {
    const INFO: Info = Info::new("sensor_drift", Stage::Instrument)
        .summary("zero of the load cell drifts linearly during a run")
        .equation("r -> r + d t, t since the start of the run")
        .source("Gautschi 2002 (charge leak of piezo cells)")
        .limits(
            "linear, from zero in each run; the leakage of a piezo cell saturates after \
                 its time constant",
        )
        .parameters(&[Parameter::new(
            "d",
            "N/s",
            "change of the reading per second",
            [-1e4, 1e4],
            &[0.005],
        )
        .null(0.0)
        .signed()]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            slope_n_s: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Instrument<T> for SensorDrift<T> {
    fn first(&self, _state: &mut (), force_n: T) -> T {
        force_n
    }

    #[inline(always)]
    fn step(&self, _state: &mut (), signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let before = signal.begin_n + self.slope_n_s * (time_s - dt_s);
        let mut after = signal.shifted(self.slope_n_s * time_s);
        after.begin_n = before;
        after
    }
}
