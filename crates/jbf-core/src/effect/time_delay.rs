//! Time delay `r(t) = F(t - tau)`: the recorded force is delayed without a change of shape.
//!
//! Source: Hess & Soom (1990) for friction that lags the speed by a fixed time; in the instrument
//! it is the skew between two channels, a linear-phase filter, or a bus.
//!
//! Unlike a low-pass filter, this effect does not smooth the signal. The force is stored at the
//! ends of the steps and interpolated linearly. A delay of any length, including less than a
//! sample, therefore has a derivative. A jump of the force becomes a ramp of one step in the
//! reading.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::delay_line::DelayLine;
use crate::described::described;
use crate::motion::Motion;
use crate::real::Real;

/// Time delay of the recorded force relative to the recorded motion.
#[derive(Clone, Copy, Debug)]
pub struct TimeDelay<T> {
    tau_s: T,
}

/// Recent history of the force, and the delayed reading.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    line: DelayLine<T>,
    reading_n: T,
}

described! {
    named_effect TimeDelay = Info::new::<T, Self>("time_delay", Stage::Instrument)
        .summary("delay of the friction record relative to the motion record")
        .equation("r(t) = F(t - tau)")
        .source("Hess & Soom 1990; channel skew of any two-instrument record")
        .limits(
            "one delay for all frequencies and all runs; a filter is sensor_lag; clock drift \
             is not included",
        );
    tau_s = "tau_s", "s", "delay of the friction record",
        [0.0, 2.0], [0.025, 0.085, 0.235] null(0.0);
}

impl<T: Real> TimeDelay<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { tau_s: p.tau_s }
    }
}

impl<T: Real> Effect<T> for TimeDelay<T> {
    type State = State<T>;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            line: DelayLine::new(),
            reading_n: T::ZERO,
        }
    }

    /// Starts the delay line; the force before the run is assumed to equal that at its start.
    fn first_reading(&self, state: &mut State<T>, force_n: &mut T) {
        state.line.push(*force_n, T::ZERO, self.tau_s);
        state.reading_n = *force_n;
    }

    #[inline(always)]
    fn reading(&self, state: &mut State<T>, signal: &mut Signal<T>, _time_s: T, dt_s: T) {
        state.line.push(signal.now_n, dt_s, self.tau_s);
        let begin_n = state.reading_n;
        state.reading_n = state.line.back(self.tau_s);
        if self.tau_s.value() <= 0.0 {
            // Without delay the jumps remain; the derivative is that of the ramp.
            *signal = signal.shifted(state.reading_n - signal.now_n);
            return;
        }
        *signal = Signal {
            begin_n,
            end_n: state.reading_n,
            now_n: state.reading_n,
        };
    }
}
