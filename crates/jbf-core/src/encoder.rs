//! Incremental encoder: converts a counter that rolls over to an angle without roll-over.

use crate::error::{check, positive, within, Error};
use crate::real::Real;

/// Conversion of encoder counts to radians, with roll-over and detection of jumps.
#[derive(Clone, Copy, Debug)]
pub struct Encoder<T> {
    rad_per_count: T,
    /// Shift that moves the sign bit of the counter to the top of an `i32`.
    shift: u32,
    most_counts: i32,
}

/// Counter values of an encoder and the number of samples without a count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State {
    last: u32,
    total: i64,
    started: bool,
    still: u32,
}

/// Motion of the shaft in one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sample<T> {
    /// Rotation since the previous sample, rad; zero if the counter jumped.
    pub moved_rad: T,
    /// True if the counter changed by more than the shaft can move; the change is then ignored.
    pub jumped: bool,
    /// Number of samples since the counter last changed.
    pub still: u32,
}

impl<T: Real> Encoder<T> {
    /// Creates an encoder with `counts_per_rad` counts per radian and a counter of `bits` bits.
    ///
    /// `top_speed_rad_s` is the highest speed of the shaft (rad/s). A change of the counter by more
    /// than this speed allows within `dt_s` is a jump.
    ///
    /// # Errors
    /// Sizes must be positive. The counter must have 8 to 32 bits and more than twice the counts of
    /// one step at the highest speed; otherwise a roll-over is ambiguous.
    pub fn new(
        counts_per_rad: f64,
        bits: u32,
        top_speed_rad_s: f64,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("counts_per_rad", counts_per_rad)?;
        positive("top_speed_rad_s", top_speed_rad_s)?;
        positive("dt_s", dt_s)?;
        within("bits", f64::from(bits), [8.0, 32.0])?;
        let most = counts_per_rad * top_speed_rad_s * dt_s + 2.0;
        let half = libm::exp2(f64::from(bits) - 1.0);
        check(
            most < half,
            "top_speed_rad_s",
            top_speed_rad_s,
            "exceeds half the counter's range in one step: a roll-over is ambiguous",
        )?;
        Ok(Self {
            rad_per_count: T::of(1.0 / counts_per_rad),
            shift: 32 - bits,
            most_counts: most as i32,
        })
    }

    /// Processes a counter value and returns the motion of the shaft since the previous one.
    #[inline]
    pub fn step(&self, state: &mut State, counter: u32) -> Sample<T> {
        let raw = counter.wrapping_sub(state.last) << self.shift;
        // An arithmetic shift restores the sign: the shorter direction round the counter.
        let moved = (raw as i32) >> self.shift;
        state.last = counter;
        if !state.started {
            state.started = true;
            return Sample {
                moved_rad: T::ZERO,
                jumped: false,
                still: 0,
            };
        }
        let jumped = moved > self.most_counts || moved < -self.most_counts;
        let believed = if jumped { 0 } else { moved };
        state.still = if moved == 0 {
            state.still.saturating_add(1)
        } else {
            0
        };
        state.total = state.total.wrapping_add(i64::from(believed));
        Sample {
            moved_rad: T::from_i32(believed) * self.rad_per_count,
            jumped,
            still: state.still,
        }
    }

    /// Returns the angle since the first sample, rad, without the accumulated rounding error of a
    /// sum of increments.
    #[inline]
    #[must_use]
    pub fn angle_rad(&self, state: &State) -> T {
        let high = (state.total >> 20) as i32;
        let low = (state.total & 0xf_ffff) as i32;
        (T::from_i32(high) * T::of(1_048_576.0) + T::from_i32(low)) * self.rad_per_count
    }
}
