//! What one step of a loop says.

use super::Status;
use crate::compensator::Answer;
use crate::real::Real;

/// Everything about one step, for logging.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Parts<T> {
    /// Angle since the start, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// What is controlled minus its reference, rad or rad/s.
    pub error: T,
    /// The control law's share, V.
    pub base_v: T,
    /// The compensator's share and its parts.
    pub compensation: Answer<T>,
    /// What goes to the amplifier, V: finite, within the limit.
    pub output_v: T,
    /// How the loop is.
    pub status: Status,
}

impl<T: Real> Parts<T> {
    /// The same in another kind of number.
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
