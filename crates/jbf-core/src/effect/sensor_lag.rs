//! `tau r' = F - r`: a first-order low pass between force and record.
//!
//! Source: Cohn (1998), section 4.1 (the load cell's signal is low-passed).

use super::relaxation::relax;
use super::{Effect, Info, Instrument, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::real::Real;

/// First-order low pass of the load cell.
#[derive(Clone, Copy, Debug)]
pub struct SensorLag<T> {
    tau_s: T,
}

/// The reading, and the force that it follows.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    reading_n: T,
    force_n: T,
}

impl<T: Real> Effect<T> for SensorLag<T> {
    const INFO: Info = Info {
        name: "sensor_lag",
        stage: Stage::Instrument,
        summary: "the load cell or its filter follows the force late",
        equation: "tau r' = F - r",
        source: "Cohn 1998, section 4.1",
        limits:
            "one pole; a steep filter delays more than it rounds; a pure delay is another effect",
        parameters: &[Parameter {
            name: "tau_s",
            unit: "s",
            meaning: "time constant",
            lower: 0.0,
            upper: 1e2,
            null: Some(0.0),
            starts: &[0.05, 0.3],
            log: false,
            period: None,
        }],
        needs_angle: false,
    };
    type State = State<T>;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            tau_s: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            reading_n: T::ZERO,
            force_n: T::ZERO,
        }
    }
}

impl<T: Real> Instrument<T> for SensorLag<T> {
    fn first(&self, state: &mut State<T>, force_n: T) -> T {
        *state = State {
            reading_n: force_n,
            force_n,
        };
        force_n
    }

    #[inline]
    fn step(&self, state: &mut State<T>, force_n: T, _time_s: T, dt_s: T) -> T {
        let from = state.force_n;
        state.force_n = force_n;
        state.reading_n = if self.tau_s.value() * 700.0 > dt_s.value() {
            relax(state.reading_n, [from, force_n], dt_s / self.tau_s)
        } else {
            // The limit of a short time constant, with its slope: F - tau F'.
            force_n - (force_n - from) * (self.tau_s / dt_s)
        };
        state.reading_n
    }
}
