//! Sensor offset `+ b`: the zero error of the load cell.
//!
//! On a drive, the offset may also be a constant load that the transmission carries, such as the
//! weight on an inclined axis.
//!
//! Source: any strain-gauge bridge; Cohn (1998), section 4.1.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Signal, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Load cell with a zero error.
#[derive(Clone, Copy, Debug)]
pub struct SensorOffset<T> {
    offset_n: T,
}

described! {
    named_effect SensorOffset = Info::new::<T, Self>("sensor_offset", Stage::Instrument)
        .summary("zero offset of the load cell")
        .equation("r -> r + b")
        .source("Cohn 1998, section 4.1 (strain gauges)")
        .limits(
            "one offset for all runs, not one per run; on a drive it is also a constant \
             load, which `torque_proportional` includes",
        );
    b = "b", "N", "reading without force", [-1e5, 1e5], [0.3] null(0.0) .signed();
}

impl<T: Real> SensorOffset<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { offset_n: p.b }
    }
}

impl<T: Real> Effect<T> for SensorOffset<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    fn first_reading(&self, _state: &mut (), force_n: &mut T) {
        *force_n += self.offset_n;
    }

    /// Adds the constant force in the readings, which the transmission of a drive may carry.
    #[inline(always)]
    fn add_friction(
        &self,
        _state: &(),
        _journal: &JournalMotion<T>,
        _sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        *transmitted_n += self.offset_n;
    }

    #[inline(always)]
    fn reading(&self, _state: &mut (), signal: &mut Signal<T>, _time_s: T, _dt_s: T) {
        *signal = signal.shifted(self.offset_n);
    }
}
