//! The way of a step during which the speed goes on a straight line: pieces of path that each keep
//! their direction. Friction turns round with the speed, so whatever follows the way asks here where.

use crate::motion::{crossing, JournalMotion};
use crate::real::Real;

/// One piece of path in one direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leg<T> {
    /// -1, 0 or +1.
    pub direction: T,
    /// Length, m.
    pub distance_m: T,
    /// Level of friction at its two ends, in whatever unit the caller has it.
    pub level: [T; 2],
}

/// The legs of a step: one, or where the speed crosses zero two, with `turning` the level at the
/// moment of rest between them, a share of the step after its beginning.
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
