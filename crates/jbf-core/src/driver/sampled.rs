//! Recorded speed, interpolated linearly between its samples.

use super::Excitation;
use crate::error::{check, finite, Error};

/// Speed that is linear between samples, constant before the first and after the last.
///
/// An integration step ends at every sample, because a longer step could miss the changes of slope
/// at the samples.
#[derive(Clone, Copy, Debug)]
pub struct Sampled<'a> {
    time_s: &'a [f64],
    velocity_m_s: &'a [f64],
}

impl<'a> Sampled<'a> {
    /// Creates an excitation from the times (s) and speeds (m/s) of a record.
    ///
    /// # Errors
    /// The slices must have the same length, of two or more; times must rise; all values must be
    /// finite.
    pub fn new(time_s: &'a [f64], velocity_m_s: &'a [f64]) -> Result<Self, Error> {
        check(
            time_s.len() == velocity_m_s.len() && time_s.len() >= 2,
            "samples",
            velocity_m_s.len() as f64,
            "must be at least 2, and as many as the times",
        )?;
        for (i, &t) in time_s.iter().enumerate() {
            check(
                t.is_finite() && (i == 0 || t > time_s[i - 1]),
                "time_s",
                t,
                "must be finite and increasing",
            )?;
        }
        for &v in velocity_m_s {
            finite("velocity_m_s", v)?;
        }
        Ok(Self {
            time_s,
            velocity_m_s,
        })
    }

    /// Times and speeds of the two samples next to a time; `None` outside the record.
    fn round(&self, time_s: f64) -> Option<([f64; 2], [f64; 2])> {
        let after = self.time_s.partition_point(|&t| t <= time_s);
        let before = after.checked_sub(1)?;
        Some((
            [*self.time_s.get(before)?, *self.time_s.get(after)?],
            [
                *self.velocity_m_s.get(before)?,
                *self.velocity_m_s.get(after)?,
            ],
        ))
    }
}

impl Excitation for Sampled<'_> {
    fn velocity_m_s(&self, time_s: f64) -> f64 {
        match self.round(time_s) {
            Some(([t0, t1], [v0, v1])) => v0 + (v1 - v0) * ((time_s - t0) / (t1 - t0)),
            None if time_s < self.time_s[0] => self.velocity_m_s[0],
            None => self.velocity_m_s[self.velocity_m_s.len() - 1],
        }
    }

    fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.round(time_s)
            .map_or(0.0, |([t0, t1], [v0, v1])| (v1 - v0) / (t1 - t0))
    }

    fn next_kink_s(&self, time_s: f64) -> f64 {
        let Some(([t0, t1], [v0, v1])) = self.round(time_s) else {
            return if time_s < self.time_s[0] {
                self.time_s[0]
            } else {
                f64::INFINITY
            };
        };
        if v0 * v1 < 0.0 {
            let zero = t0 + (t1 - t0) * (v0 / (v0 - v1));
            // A zero on which a step has just landed is not the next one.
            if zero > time_s + 1e-9 * (t1 - t0) && zero < t1 {
                return zero;
            }
        }
        t1
    }
}
