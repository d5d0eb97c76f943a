//! Sensor hysteresis: the predicted reading changes only if the force leaves a band of half width w
//! around it.
//!
//! The cause is play or friction in the force path.
//!
//! ```text
//! r is limited to values between F - w and F + w
//! ```
//!
//! This is the play operator (Krasnosel'skii & Pokrovskii 1989; Visintin 1994). The rising and the
//! falling branch of a load cell differ by 2 w, the hysteresis in its data sheet, and the branch
//! changes when the force reverses. The effect does not depend on time. `backlash` is play in the
//! drive, across which no force is transmitted.
//!
//! This effect precedes the other effects of the instrument: the force reaches the cell through
//! parts with friction or play, the cell deflects under that force, and the electronics follow.
//!
//! The first reading of a run equals the force. At w = 0 the reading equals the force exactly. The
//! derivative with respect to w is that of the present branch: -1 if the force last rose, +1 if it
//! fell, 0 before the first change. A score test at w = 0 can therefore detect the effect.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::described::described;
use crate::motion::Motion;
use crate::real::Real;

/// Hysteresis of a load cell, from play or friction in the force path.
#[derive(Clone, Copy, Debug)]
pub struct SensorHysteresis<T> {
    half_width_n: T,
}

/// Reading of the load cell, and the branch, which determines the derivative at w = 0.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    held_n: T,
    /// Direction of the last change of the force: +1 for a rise, -1 for a fall, 0 before the first
    /// change.
    branch: i8,
}

impl<T: Real> SensorHysteresis<T> {
    /// Returns the state after the force has changed monotonically from its last value to
    /// `force_n`.
    #[inline(always)]
    fn under(&self, before: State<T>, force_n: T) -> State<T> {
        let (low_n, high_n) = (force_n - self.half_width_n, force_n + self.half_width_n);
        let (held_n, branch) = if low_n > before.held_n {
            (low_n, 1)
        } else if high_n < before.held_n {
            (high_n, -1)
        } else {
            (before.held_n, before.branch)
        };
        State { held_n, branch }
    }

    /// Returns the reading of the load cell in a state under the force `force_n`, N.
    #[inline(always)]
    fn reading_n(&self, state: State<T>, force_n: T) -> T {
        if self.half_width_n.value() > 0.0 {
            return state.held_n;
        }
        // The force itself, with its derivatives; adding negative zero preserves the sign of a
        // zero.
        force_n + T::joined(-0.0, [(self.half_width_n, -f64::from(state.branch))])
    }
}

described! {
    named_effect SensorHysteresis = Info::new::<T, Self>("sensor_hysteresis", Stage::Instrument)
        .summary(
            "load cell reads less while the force rises than while it falls: play or \
             friction in the force path",
        )
        .equation("r -> r within F - w and F + w (play)")
        .source("Krasnosel'skii & Pokrovskii 1989; Visintin 1994; VDI/VDE 2638 (hysteresis)")
        .limits(
            "constant gap; loops that widen gradually or with the force are not included; \
             each run starts at mid-gap (samples that depend on this are excluded from a fit)",
        );
    w = "w", "N", "half of the distance between the branches",
        [0.0, 1e5], [0.5] null(0.0);
}

impl<T: Real> SensorHysteresis<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { half_width_n: p.w }
    }
}

impl<T: Real> Effect<T> for SensorHysteresis<T> {
    type State = State<T>;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            held_n: T::ZERO,
            branch: 0,
        }
    }

    fn first_reading(&self, state: &mut State<T>, force_n: &mut T) {
        state.held_n = *force_n;
    }

    #[inline(always)]
    fn reading(&self, state: &mut State<T>, signal: &mut Signal<T>, _time_s: T, _dt_s: T) {
        let begin = self.under(*state, signal.begin_n);
        *state = self.under(begin, signal.end_n);
        // The force at the exact instant of a jump has no duration and moves nothing.
        let now = self.under(*state, signal.now_n);
        *signal = Signal {
            begin_n: self.reading_n(begin, signal.begin_n),
            end_n: self.reading_n(*state, signal.end_n),
            now_n: self.reading_n(now, signal.now_n),
        };
    }
}
