//! Signals of one step of a control loop.

use super::Status;
use crate::compensator::Output;
use crate::real::Real;

/// Signals of one step of a control loop, for logging.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Signals<T> {
    /// Angle since the start of the loop, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// Control error: controlled quantity minus its reference, rad or rad/s.
    pub error: T,
    /// Output of the control law, V.
    pub base_v: T,
    /// Output of the compensator and its components.
    pub compensation: Output<T>,
    /// Output voltage at the amplifier, V: finite and within the limit.
    pub output_v: T,
    /// Status flags of the loop.
    pub status: Status,
}

impl<T: Real> Signals<T> {
    /// Converts to another number type.
    #[must_use]
    pub fn cast<U: Real>(&self) -> Signals<U> {
        let cast = |value: T| U::of(value.value());
        Signals {
            angle_rad: cast(self.angle_rad),
            velocity_rad_s: cast(self.velocity_rad_s),
            error: cast(self.error),
            base_v: cast(self.base_v),
            compensation: self.compensation.cast(),
            output_v: cast(self.output_v),
            status: self.status,
        }
    }
}
