//! Limits beyond which a loop no longer trusts its encoder or compensation.

use crate::builder::with_fields;
use crate::error::{check, positive, Error};

/// A patience longer than any run.
const ENDLESS_S: f64 = 1e5;

/// Limits beyond which a loop no longer trusts its encoder or compensation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Largest output, V.
    pub output_v: f64,
    /// Voltage that certainly moves the shaft, V; a counter that does not change under it is
    /// frozen.
    pub moving_v: f64,
    /// Time limit of three conditions, s.
    ///
    /// After this time an unchanged counter counts as frozen, and a saturated output gives up
    /// compensation. After this time, too, a loop whose encoder recovered resumes compensation.
    pub patience_s: f64,
}

impl Limits {
    /// Limits of a loop that only a jump of the counter stops, as in the thesis's programs.
    ///
    /// The voltage that moves the shaft and the patience must be set separately.
    #[must_use]
    pub const fn new(output_v: f64) -> Self {
        Self {
            output_v,
            moving_v: output_v,
            patience_s: ENDLESS_S,
        }
    }

    with_fields! {
        with_moving_v => moving_v: f64,
        with_patience_s => patience_s: f64,
    }

    pub(super) fn checked(self) -> Result<Self, Error> {
        positive("output_v", self.output_v)?;
        positive("moving_v", self.moving_v)?;
        check(
            self.patience_s >= 0.0 && self.patience_s < 1e6,
            "patience_s",
            self.patience_s,
            "must be zero or positive, and below 1e6",
        )?;
        Ok(self)
    }
}
