//! A bristle that bends towards a level over the way slid, `dF/dx = sigma (1 - F/(level sgn v))`:
//! LuGre's, and that of a contact that bends under any law.

use crate::path::Leg;
use crate::real::Real;
use crate::relaxation::relax;

/// Smallest level that a bristle bends towards: keeps a level of zero from dividing.
pub(crate) const LEAST_LEVEL: f64 = 1e-9;

/// Force at the end of a leg that begins with `force`, of a bristle of `stiffness` (force over
/// length): exact in the way slid, with the level on a straight line, so no stiffness is too large.
#[inline(always)]
pub(crate) fn bent<T: Real>(force: T, leg: &Leg<T>, stiffness: T) -> T {
    if leg.distance_m.value() <= 0.0 {
        return force;
    }
    let mean = ((leg.level[0] + leg.level[1]) * T::of(0.5)).max(T::of(LEAST_LEVEL));
    let target = leg.level.map(|level| level * leg.direction);
    relax(force, target, stiffness * leg.distance_m / mean)
}
