//! Friction at one instant, in the two parts that every law, chain and loop tells apart.

use crate::real::Real;

/// `jump sgn(v) + smooth`: what takes the sign of the motion and jumps with it, and the rest.
///
/// The unit is that of whoever gives it: a law a coefficient (of one newton, and so a force, where
/// it is a law in newtons), a chain newtons on one bearing, a plant or a compensator volts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction<T> {
    /// The part that takes the sign of the motion, unsigned; at rest it holds up to this. A law
    /// with a bristle gives the level towards which the bristle bends.
    pub jump: T,
    /// The rest, signed: viscous friction, a spring.
    pub smooth: T,
}

impl<T: Real> Friction<T> {
    /// No friction.
    pub const NONE: Self = Self {
        jump: T::ZERO,
        smooth: T::ZERO,
    };

    /// All of it, for a member `direction` of the set-valued sign.
    #[inline]
    pub fn along(&self, direction: T) -> T {
        self.jump * direction + self.smooth
    }

    /// Both parts times a factor, which may be one of unit.
    #[inline]
    pub fn times(&self, factor: T) -> Self {
        Self {
            jump: self.jump * factor,
            smooth: self.smooth * factor,
        }
    }
}
