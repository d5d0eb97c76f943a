//! Friction at one instant, separated into the part that jumps with the sign of the motion and a
//! smooth part.

use crate::real::Real;

/// Friction `jump sgn(v) + smooth`: a part that jumps with the sign of the motion, and a smooth
/// part.
///
/// The unit depends on the source. A law returns a coefficient; for a law in newtons, it is
/// relative to a load of one newton. A chain returns newtons on one bearing, a plant or a
/// compensator volts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<T> {
    /// Unsigned part that has the sign of the motion; at rest, the friction takes any value up to
    /// it.
    ///
    /// A law with a bristle returns the level towards which the bristle deflects.
    pub jump: T,
    /// Signed part that is smooth in the speed: viscous friction, a spring.
    pub smooth: T,
}

impl<T: Real> Friction<T> {
    /// Zero friction.
    pub const NONE: Self = Self {
        jump: T::ZERO,
        smooth: T::ZERO,
    };

    /// Returns the total friction for a `direction` in [-1, 1], the set-valued sign of the motion.
    #[inline]
    pub fn along(&self, direction: T) -> T {
        self.jump * direction + self.smooth
    }

    /// Returns both parts multiplied by a factor, which may change the unit.
    #[inline]
    pub(crate) fn times(&self, factor: T) -> Self {
        Self {
            jump: self.jump * factor,
            smooth: self.smooth * factor,
        }
    }
}
