//! The way of a step as bristles see it: pieces of path in one direction each.

use crate::motion::JournalMotion;
use crate::real::Real;

/// Smallest level, N, that a bristle bends towards: keeps a level of zero from dividing.
pub(super) const LEAST_LEVEL_N: f64 = 1e-9;

/// One piece of path in one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg<T> {
    /// -1, 0 or +1.
    pub direction: T,
    /// Length, m.
    pub distance_m: T,
    /// Level of friction at its two ends, N.
    pub level: [T; 2],
}

/// The legs of a step during which the speed goes on a straight line: one, or where it
/// crosses zero two, with `turning_n` the level at the moment of rest between them.
#[inline(always)]
pub(super) fn legs<T: Real>(
    from: &JournalMotion<T>,
    to: &JournalMotion<T>,
    level: [T; 2],
    turning_n: impl FnOnce() -> T,
    dt_s: T,
) -> [Option<Leg<T>>; 2] {
    let (v0, v1) = (from.velocity_m_s, to.velocity_m_s);
    let half = T::of(0.5) * dt_s;
    if v0.value() * v1.value() < 0.0 {
        let share = v0 / (v0 - v1);
        let middle = turning_n();
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
