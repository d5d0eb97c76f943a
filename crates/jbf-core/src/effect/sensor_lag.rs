//! Sensor lag `tau r' = F - r`: a first-order low-pass filter between force and record.
//!
//! Source: Cohn (1998), section 4.1 (the load cell's signal is low-passed).

use super::{Effect, Info, Instrument, Parameter, Rig, Signal, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::page::Start;
use crate::real::Real;
use crate::relaxation::relax;

/// First-order low-pass filter of the load cell.
#[derive(Clone, Copy, Debug)]
pub struct SensorLag<T> {
    tau_s: T,
}

impl<T: Real> Effect<T> for SensorLag<T> {
    const INFO: Info = Info::new("sensor_lag", Stage::Instrument)
        .summary("load cell or its filter follows the force with a time lag")
        .equation("tau r' = F - r")
        .source("Cohn 1998, section 4.1")
        .limits(
            "first order; a steep filter delays more than it smooths; a pure delay is time_delay",
        )
        .parameters(&[
            Parameter::new("tau_s", "s", "time constant", [0.0, 1e2], &[0.05, 0.3])
                .null(0.0)
                .start(Start::Lateness),
        ]);
    const SPREADS_JUMPS: bool = true;
    /// Reading of the load cell, N.
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            tau_s: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> T {
        T::ZERO
    }
}

impl<T: Real> Instrument<T> for SensorLag<T> {
    fn first(&self, state: &mut T, force_n: T) -> T {
        *state = force_n;
        force_n
    }

    #[inline(always)]
    fn step(&self, state: &mut T, signal: Signal<T>, _time_s: T, dt_s: T) -> Signal<T> {
        let begin_n = *state;
        // Below the resolution of a step the lag takes its limit: no lag, or a shift by tau.
        let ratio = dt_s / self.tau_s;
        *state = if self.tau_s.value() <= 0.0 {
            signal.now_n - (signal.end_n - signal.begin_n) * (self.tau_s / dt_s)
        } else if ratio.value() > 700.0 {
            signal.end_n - (signal.end_n - signal.begin_n) / ratio
        } else {
            relax(begin_n, [signal.begin_n, signal.end_n], ratio)
        };
        Signal {
            begin_n,
            end_n: *state,
            now_n: *state,
        }
    }
}
