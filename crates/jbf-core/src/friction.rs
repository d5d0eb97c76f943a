//! Friction at one instant, in the two parts that all laws, chains and loops distinguish.

use crate::real::Real;

/// Friction `jump sgn(v) + smooth`: the part that jumps with the sign of the motion, and the rest.
///
/// The unit depends on the source. A law returns a coefficient (or, for a law in newtons, a force,
/// as the coefficient of one newton). A chain returns newtons on one bearing, a plant or a
/// compensator volts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<T> {
    /// Unsigned part that takes the sign of the motion; at rest it holds up to this value.
    ///
    /// A law with a bristle returns the level towards which the bristle deflects.
    pub jump: T,
    /// Remaining signed part: viscous friction, a spring.
    pub smooth: T,
}

impl<T: Real> Friction<T> {
    /// No friction.
    pub const NONE: Self = Self {
        jump: T::ZERO,
        smooth: T::ZERO,
    };

    /// Total friction for a member `direction` of the set-valued sign.
    #[inline]
    pub fn along(&self, direction: T) -> T {
        self.jump * direction + self.smooth
    }

    /// Both parts times a factor, which may change the unit.
    #[inline]
    pub fn times(&self, factor: T) -> Self {
        Self {
            jump: self.jump * factor,
            smooth: self.smooth * factor,
        }
    }
}
