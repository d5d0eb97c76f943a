//! Friction laws, one a file. A law turns speed into a friction coefficient; what a rig
//! adds to it belongs to [`crate::effect`].

pub mod journal;
pub mod journal_full;
mod steady;

pub use steady::Steady;

use crate::real::Real;

/// The friction of a law at one instant, in parts because people log them and because
/// effects act on one or the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding<T> {
    /// Coefficient of the part that takes the sign of the motion, unsigned.
    pub level: T,
    /// Coefficient of the viscous part, signed.
    pub viscous: T,
}

impl<T: Real> Sliding<T> {
    /// The whole coefficient for a member `direction` of the set-valued sign.
    #[inline]
    pub fn coefficient(&self, direction: T) -> T {
        self.level * direction + self.viscous
    }
}

/// A friction law: configuration here, what changes in `State`.
pub trait Law<T: Real> {
    /// What the law remembers.
    type State: Copy;

    /// The state at which every run starts.
    fn start(&self, load_n: T) -> Self::State;

    /// The load (N) that the law computes with, and that its coefficient refers to: a law
    /// may have a lightest one.
    fn pressed_n(&self, load_n: T) -> T {
        load_n.max(T::ZERO)
    }

    /// Take a new load; cheap when it did not change.
    fn set_load(&self, state: &mut Self::State, load_n: T);

    /// Friction now, at the film speed `velocity_m_s` (signed).
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Sliding<T>;

    /// Longest step, s, that the law's own stepper takes without loss up to a speed.
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64;

    /// Advance by `dt_s`; `speed_m_s` is |U| at the start, middle and end of the step, and
    /// `rate` a factor on the law's own clock.
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T);
}
