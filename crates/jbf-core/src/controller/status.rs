//! Status flags of a control loop.

use core::ops::{BitOr, BitOrAssign};

/// Status flags of one step of a control loop; [`Status::OK`] has no flag set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Status(u8);

impl Status {
    /// No flag is set.
    pub const OK: Self = Self(0);
    /// The output is at its limit; nothing is learned.
    pub const SATURATED: Self = Self(1);
    /// The counter does not change although the voltage should move the shaft.
    pub const FROZEN: Self = Self(2);
    /// The counter changed by more than the shaft can move.
    pub const JUMPED: Self = Self(4);
    /// The reference is not finite; the last finite one is used.
    pub const NOT_FINITE: Self = Self(8);
    /// The control law acts alone, without compensation.
    pub const FALLBACK: Self = Self(16);

    /// Returns true if any flag of `other` is set in `self`.
    #[inline]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the flags as a number, for logging.
    pub const fn bits(self) -> u8 {
        self.0
    }
}

impl BitOr for Status {
    type Output = Self;

    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Status {
    #[inline]
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
