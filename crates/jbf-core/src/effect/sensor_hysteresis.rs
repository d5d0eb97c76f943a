//! The reading follows the force only at the ends of a gap of half width w: play, or friction, in
//! the force path.
//!
//! ```text
//! r -> r held between F - w and F + w
//! ```
//!
//! The play operator (Krasnosel'skii & Pokrovskii 1989; Visintin 1994): a load cell's branches,
//! rising and falling, lie 2 w apart, as its data sheet's hysteresis says, and it goes from one to
//! the other where the force turns round. It knows no time. `backlash` is play in the drive, across
//! which no force is felt at all.
//!
//! It stands first in the instrument: the force reaches the cell through what sticks or gives, the
//! cell bends under what reaches it, and the electronics come last.
//!
//! The first reading of a run is its force. At w = 0 the reading is the force, to the bit, and its
//! slope is that of the branch on which the force last moved: -1 rising, +1 falling, 0 before it has
//! moved. So the effect shows in a slope before it is there.

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

/// The reading, and on which branch it is where there is no gap.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    held_n: T,
    /// +1 where the force last rose, -1 where it fell, 0 before it moved.
    branch: i8,
}

impl<T: Real> SensorHysteresis<T> {
    /// The state under a force, monotone from the last one.
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

    /// What the cell shows in a state, under this force.
    #[inline(always)]
    fn reading_n(&self, state: State<T>, force_n: T) -> T {
        if self.half_width_n.value() > 0.0 {
            return state.held_n;
        }
        // The force itself, of whatever slopes; negative zero leaves its sign, too.
        force_n + T::joined(-0.0, [(self.half_width_n, -f64::from(state.branch))])
    }
}

impl<T: Real> Effect<T> for SensorHysteresis<T> {
    const INFO: Info = Info::new("sensor_hysteresis", Stage::Instrument)
        .summary(
            "the load cell reads less while the force rises than while it falls: play or friction \
                  in the force path",
        )
        .equation("r -> r held between F - w and F + w (play)")
        .source("Krasnosel'skii & Pokrovskii 1989; Visintin 1994; VDI/VDE 2638 (hysteresis)")
        .limits(
            "one gap, the same at every force: branches that part slowly, or the more the larger \
                 the force, are another form; each run begins in the middle of the gap, wherever \
                 it was: a fit sets aside what remembers that",
        )
        .unknown_start()
        .parameters(&[Parameter::new(
            "w_n",
            "N",
            "half the way between the branches",
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
        // What friction is at the very instant of a jump lasts no time and moves nothing.
        let now = self.under(*state, signal.now_n);
        Signal {
            begin_n: self.reading_n(begin, signal.begin_n),
            end_n: self.reading_n(*state, signal.end_n),
            now_n: self.reading_n(now, signal.now_n),
        }
    }
}
