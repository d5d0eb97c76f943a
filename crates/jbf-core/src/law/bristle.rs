//! Bristle that deflects towards a level over the sliding distance, `dF/dx = sigma (1 - F/(level
//! sgn v))`.
//!
//! The LuGre law and the effect `presliding` use this bristle.

use crate::motion::JournalMotion;
use crate::path::{legs, Leg};
use crate::real::Real;
use crate::relaxation::relax;

/// Smallest friction level towards which a bristle deflects, a limit that prevents a division by
/// zero.
pub(crate) const LEAST_LEVEL: f64 = 1e-9;

/// Force of a bristle at the end of a leg (a part of a step in one direction) that begins with
/// `force`.
///
/// `stiffness` is the force per length. The solution is exact in the sliding distance for a level
/// that changes linearly, so any stiffness is stable.
#[inline(always)]
pub(crate) fn bent<T: Real>(force: T, leg: &Leg<T>, stiffness: T) -> T {
    if leg.distance_m.value() <= 0.0 {
        return force;
    }
    let mean = ((leg.level[0] + leg.level[1]) * T::of(0.5)).max(T::of(LEAST_LEVEL));
    let target = leg.level.map(|level| level * leg.direction);
    relax(force, target, stiffness * leg.distance_m / mean)
}

/// Advances the `force` of a bristle through a step by `slide`, and returns the force at its end.
///
/// The level at a reversal is the mean of those at the ends of the step, as for a law whose dry
/// friction does not depend on the speed. In a step of zero length the bristle slides.
#[inline(always)]
pub(crate) fn along<T: Real>(
    force: &mut T,
    from: &JournalMotion<T>,
    to: &JournalMotion<T>,
    level: [T; 2],
    dt_s: T,
    slide: impl Fn(T, &Leg<T>) -> T,
) -> T {
    if dt_s.value() <= 0.0 {
        *force = level[1] * to.velocity_m_s.sign();
        return *force;
    }
    let turning = |_| (level[0] + level[1]) * T::of(0.5);
    for leg in legs(from, to, level, turning, dt_s).iter().flatten() {
        *force = slide(*force, leg);
    }
    *force
}
