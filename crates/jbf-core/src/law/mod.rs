//! Friction laws, one a file. A law turns speed into a friction coefficient; what a rig
//! adds to it belongs to [`crate::effect`].

pub mod journal;
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

/// Lightest load that a law computes with, N: a bearing that is lifted or not pressed has no
/// friction coefficient, and a step must not divide by its load.
pub const LIGHTEST_LOAD_N: f64 = 1e-6;

/// The load that presses, N: `load_n`, or [`LIGHTEST_LOAD_N`] where that is larger.
#[inline]
pub fn pressed_n<T: Real>(load_n: T) -> T {
    load_n.max(T::of(LIGHTEST_LOAD_N))
}

/// A friction law: configuration here, what changes in `State`.
pub trait Law<T: Real> {
    /// What the law remembers.
    type State: Copy;

    /// The state at which every run starts.
    fn start(&self, load_n: T) -> Self::State;

    /// Take a new load; cheap when it did not change.
    fn set_load(&self, state: &mut Self::State, load_n: T);

    /// Friction now, at the film speed `velocity_m_s` (signed).
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Sliding<T>;

    /// Advance by `dt_s`; `speed_m_s` is |U| at the start, middle and end of the step, and
    /// `rate` a factor on the law's own clock.
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T);
}
