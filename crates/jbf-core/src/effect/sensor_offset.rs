//! Sensor offset `+ b`: the zero error of the load cell.
//!
//! On a drive, the offset may also be a constant load that the transmission carries, such as the
//! weight on an inclined axis.
//!
//! Source: any strain-gauge bridge; Cohn (1998), section 4.1.

use super::{Effect, Info, Instrument, Parameter, Rig, Signal, Stage};
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::real::Real;

/// Load cell with a zero error.
#[derive(Clone, Copy, Debug)]
pub struct SensorOffset<T> {
    offset_n: T,
}

impl<T: Real> Effect<T> for SensorOffset<T> {
    const INFO: Info = Info::new("sensor_offset", Stage::Instrument)
        .summary("zero offset of the load cell")
        .equation("r -> r + b")
        .source("Cohn 1998, section 4.1 (strain gauges)")
        .limits(
            "one offset for all runs, not one per run; on a drive it is also a constant \
             load, which `torque_proportional` includes",
        )
        .parameters(&[
            Parameter::new("b", "N", "reading without force", [-1e5, 1e5], &[0.3])
                .null(0.0)
                .signed(),
        ]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            offset_n: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Instrument<T> for SensorOffset<T> {
    fn first(&self, _state: &mut (), force_n: T) -> T {
        force_n + self.offset_n
    }

    fn constant_n(&self) -> T {
        self.offset_n
    }

    #[inline(always)]
    fn step(&self, _state: &mut (), signal: Signal<T>, _time_s: T, _dt_s: T) -> Signal<T> {
        signal.shifted(self.offset_n)
    }
}
