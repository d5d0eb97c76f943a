//! Signals of one step of a control loop.

use super::Status;
use crate::compensator::Answer;
use crate::real::Real;

/// Signals of one step of a control loop, for logging.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Parts<T> {
    /// Angle since the start of the loop, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// Control error: controlled quantity minus its reference, rad or rad/s.
    pub error: T,
    /// Output of the control law, V.
    pub base_v: T,
    /// Output of the compensator and its components.
    pub compensation: Answer<T>,
    /// Output voltage at the amplifier, V: finite and within the limit.
    pub output_v: T,
    /// Status flags of the loop.
    pub status: Status,
}

impl<T: Real> Parts<T> {
    /// Converts to another number type.
    #[must_use]
    pub fn lift<U: Real>(&self) -> Parts<U> {
        let lift = |value: T| U::of(value.value());
        Parts {
            angle_rad: lift(self.angle_rad),
            velocity_rad_s: lift(self.velocity_rad_s),
            error: lift(self.error),
            base_v: lift(self.base_v),
            compensation: self.compensation.lift(),
            output_v: lift(self.output_v),
            status: self.status,
        }
    }
}
