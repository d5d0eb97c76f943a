//! Sensor lag `tau r' = F - r`: a first-order low-pass filter between force and record.
//!
//! Source: Cohn (1998), section 4.1 (the load cell's signal is low-passed).

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::described::described;
use crate::motion::Motion;
use crate::real::Real;
use crate::relaxation::relax;

/// First-order low-pass filter of the load cell.
#[derive(Clone, Copy, Debug)]
pub struct SensorLag<T> {
    tau_s: T,
}

described! {
    named_effect SensorLag = Info::new::<T, Self>("sensor_lag", Stage::Instrument)
        .summary("load cell or its filter follows the force with a time lag")
        .equation("tau r' = F - r")
        .source("Cohn 1998, section 4.1")
        .limits(
            "first order; a steep filter delays more than it smooths; a pure delay is time_delay",
        );
    tau_s = "tau_s", "s", "time constant",
        [0.0, 1e2], [0.05, 0.3] null(0.0);
}

impl<T: Real> SensorLag<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { tau_s: p.tau_s }
    }
}

impl<T: Real> Effect<T> for SensorLag<T> {
    /// Reading of the load cell, N.
    type State = T;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> T {
        T::ZERO
    }

    fn first_reading(&self, state: &mut T, force_n: &mut T) {
        *state = *force_n;
    }

    #[inline(always)]
    fn reading(&self, state: &mut T, signal: &mut Signal<T>, _time_s: T, dt_s: T) {
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
        *signal = Signal {
            begin_n,
            end_n: *state,
            now_n: *state,
        };
    }
}
