//! Sensor hysteresis: the reading follows the force only at the ends of a gap of half width w.
//!
//! The cause is play or friction in the force path.
//!
//! ```text
//! r -> r held between F - w and F + w
//! ```
//!
//! This is the play operator (Krasnosel'skii & Pokrovskii 1989; Visintin 1994). The rising and the
//! falling branch of a load cell are 2 w apart, the hysteresis of its data sheet, and the reading
//! changes branch where the force reverses. It does not depend on time. `backlash` is play in the
//! drive, across which no force is transmitted.
//!
//! The effect is the first of the instrument: the force reaches the cell through parts that stick
//! or have play, the cell deflects under that force, and the electronics come last.
//!
//! The first reading of a run equals its force. At w = 0 the reading equals the force exactly. Its
//! derivative with respect to w is that of the branch on which the force last moved: -1 rising, +1
//! falling, 0 before it has moved. The effect is therefore visible in the derivative at w = 0.

use super::{Effect, Info, Instrument, Parameter, Rig, Signal, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::page::Start;
use crate::real::Real;

/// Play between the force and the load cell.
#[derive(Clone, Copy, Debug)]
pub struct SensorHysteresis<T> {
    half_width_n: T,
}

/// The reading, and its branch, which matters without a gap.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    held_n: T,
    /// +1 where the force last rose, -1 where it fell, 0 before it moved.
    branch: i8,
}

impl<T: Real> SensorHysteresis<T> {
    /// State under a force that changes monotonically from the last one.
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

    /// Reading of the cell in a state, under this force.
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

impl<T: Real> Effect<T> for SensorHysteresis<T> {
    const INFO: Info = Info::new("sensor_hysteresis", Stage::Instrument)
        .summary(
            "load cell reads less while the force rises than while it falls: play or \
             friction in the force path",
        )
        .equation("r -> r within F - w and F + w (play)")
        .source("Krasnosel'skii & Pokrovskii 1989; Visintin 1994; VDI/VDE 2638 (hysteresis)")
        .limits(
            "constant gap; loops that widen gradually or with the force are not included; \
             each run starts at mid-gap (samples that depend on this are excluded from a fit)",
        )
        .unknown_start()
        .parameters(&[Parameter::new(
            "w",
            "N",
            "half of the distance between the branches",
            [0.0, 1e5],
            &[0.5],
        )
        .null(0.0)
        .start(Start::CellPlay)]);
    type State = State<T>;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            half_width_n: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            held_n: T::ZERO,
            branch: 0,
        }
    }
}

impl<T: Real> Instrument<T> for SensorHysteresis<T> {
    fn first(&self, state: &mut State<T>, force_n: T) -> T {
        state.held_n = force_n;
        force_n
    }

    #[inline(always)]
    fn step(&self, state: &mut State<T>, signal: Signal<T>, _time_s: T, _dt_s: T) -> Signal<T> {
        let begin = self.under(*state, signal.begin_n);
        *state = self.under(begin, signal.end_n);
        // The force at the exact instant of a jump has no duration and moves nothing.
        let now = self.under(*state, signal.now_n);
        Signal {
            begin_n: self.reading_n(begin, signal.begin_n),
            end_n: self.reading_n(*state, signal.end_n),
            now_n: self.reading_n(now, signal.now_n),
        }
    }
}
