//! When a loop stops believing.

use crate::builder::with_fields;
use crate::error::{check, positive, Error};

/// A patience that outlasts every run.
const ENDLESS_S: f64 = 1e5;

/// When a loop stops believing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Largest output, V.
    pub output_v: f64,
    /// A voltage that surely moves the shaft, V: a counter that stands still under it is frozen.
    pub moving_v: f64,
    /// Time after which a still counter is frozen, a limited output gives up compensation, and a
    /// loop that sees again compensates again, s.
    pub patience_s: f64,
}

impl Limits {
    /// A loop that only a jump of the counter stops, as the thesis's programs ran: what moves
    /// the shaft, and for how long to believe it, are to be told.
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
