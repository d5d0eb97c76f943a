//! Compensation by a look-up table of friction against speed or against the angle within a turn.
//!
//! Values between the entries are interpolated linearly.
//!
//! Source: Armstrong-Helouvry (1991), break-away torque against position; Cohn (1998), section
//! 2.4.1.

use super::{Compensator, Input, Output};
use crate::error::{check, finite, positive, Error};
use crate::real::Real;

/// Independent variable of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Axis {
    /// Absolute speed, from zero; the last entry applies to all higher speeds.
    Speed,
    /// Angle; the table covers one period and repeats.
    Angle,
}

/// Look-up table of `N` friction levels (V) at equal intervals.
#[derive(Clone, Copy, Debug)]
pub struct Table<T, const N: usize> {
    level_v: [T; N],
    axis: Axis,
    inverse_width: T,
    viscous_v_s: T,
}

impl<T: Real, const N: usize> Table<T, N> {
    /// Creates a table of levels (V, unsigned) at intervals of `width` (rad/s or rad), plus a
    /// viscous friction (V s/rad).
    ///
    /// # Errors
    /// Requires at least two levels, all finite, and a positive width.
    pub fn new(level_v: [T; N], axis: Axis, width: f64, viscous_v_s: f64) -> Result<Self, Error> {
        positive("width", width)?;
        check(N >= 2, "entries", N as f64, "must be at least 2")?;
        finite("viscous_v_s", viscous_v_s)?;
        for level in &level_v {
            finite("level_v", level.value())?;
        }
        Ok(Self {
            level_v,
            axis,
            inverse_width: T::of(1.0 / width),
            viscous_v_s: T::of(viscous_v_s),
        })
    }

    /// Returns the friction level at a speed (rad/s) or an angle (rad), V.
    #[inline]
    #[must_use]
    pub fn at(&self, place: T) -> T {
        let last = T::from_i32(N as i32 - 1);
        let raw = place * self.inverse_width;
        let at = match self.axis {
            Axis::Speed => raw.abs().min(last),
            Axis::Angle => {
                let turns = raw * T::of(1.0 / N as f64);
                (turns - T::from_i32(turns.floor_i32())) * T::from_i32(N as i32)
            }
        };
        let below = at.floor_i32().max(0);
        let i = (below as usize).min(N - 1);
        let j = match self.axis {
            Axis::Speed => (i + 1).min(N - 1),
            Axis::Angle => (i + 1) % N,
        };
        match (self.level_v.get(i), self.level_v.get(j)) {
            (Some(&low), Some(&high)) => low + (high - low) * (at - T::from_i32(below)),
            _ => T::ZERO,
        }
    }
}

impl<T: Real, const N: usize> Compensator<T> for Table<T, N> {
    type State = ();

    fn start(&self) {}

    #[inline]
    fn step(&self, _state: &mut (), input: &Input<T>) -> Output<T> {
        let v = input.velocity_rad_s;
        let level_v = match self.axis {
            Axis::Speed => self.at(v),
            Axis::Angle => self.at(input.angle_rad),
        };
        let friction_v = level_v * v.sign() + self.viscous_v_s * v;
        Output::of(friction_v, [level_v, T::ZERO])
    }
}
