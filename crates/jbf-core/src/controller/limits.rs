//! Limits beyond which a control loop considers its encoder faulty or stops compensation.

use crate::builder::with_fields;
use crate::error::{check, positive, Error};

/// A time limit longer than any run, s.
const ENDLESS_S: f64 = 1e5;

/// Limits beyond which a control loop considers its encoder faulty or stops compensation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Largest output voltage, V.
    pub output_v: f64,
    /// Voltage that certainly moves the shaft, V. A counter that does not change under this voltage
    /// is reported as frozen.
    pub moving_v: f64,
    /// Time after which the loop reacts to a fault or to its end, s.
    ///
    /// After this time, an unchanged counter is reported as frozen, compensation stops if the
    /// output is saturated, and compensation resumes if the encoder works again.
    pub patience_s: f64,
}

impl Limits {
    /// Creates limits for a loop in which only a jump of the counter is a fault, as in Cohn (1998).
    ///
    /// Set [`moving_v`](Self::moving_v) and [`patience_s`](Self::patience_s) as well, so that the loop
    /// detects a counter that does not change and an output that remains saturated.
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
