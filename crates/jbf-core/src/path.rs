//! Path of a step with linear speed, divided into legs of constant direction.
//!
//! Friction reverses with the speed, so every quantity that depends on the path needs the instant
//! of the reversal.

use crate::motion::{crossing, JournalMotion};
use crate::real::Real;

/// Leg of a step: the part in one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg<T> {
    /// Direction of motion: -1, 0 or +1.
    pub direction: T,
    /// Length of the leg, m.
    pub distance_m: T,
    /// Friction level at both ends of the leg, in the unit of the caller.
    pub level: [T; 2],
}

/// Divides a step into legs: one, or two if the speed crosses zero.
///
/// `turning` returns the friction level at the reversal, from the fraction of the step before it.
#[inline(always)]
pub(crate) fn legs<T: Real>(
    from: &JournalMotion<T>,
    to: &JournalMotion<T>,
    level: [T; 2],
    turning: impl FnOnce(T) -> T,
    dt_s: T,
) -> [Option<Leg<T>>; 2] {
    let (v0, v1) = (from.velocity_m_s, to.velocity_m_s);
    let half = T::of(0.5) * dt_s;
    if let Some(share) = crossing(v0, v1) {
        let middle = turning(share);
        let out = Leg {
            direction: v0.sign(),
            distance_m: v0.abs() * share * half,
            level: [level[0], middle],
        };
        let back = Leg {
            direction: v1.sign(),
            distance_m: v1.abs() * (T::ONE - share) * half,
            level: [middle, level[1]],
        };
        [Some(out), Some(back)]
    } else {
        let sum = v0 + v1;
        let only = Leg {
            direction: sum.sign(),
            distance_m: sum.abs() * half,
            level,
        };
        [Some(only), None]
    }
}
