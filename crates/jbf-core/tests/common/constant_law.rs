//! A law with a constant coefficient, for comparison of effects with closed forms.
//!
//! It also shows that a law can be implemented outside the crate.

use jbf_core::law::Law;
use jbf_core::Friction;
use jbf_core::Real;

/// A constant friction coefficient.
#[derive(Clone, Copy, Debug)]
pub struct ConstantLaw(pub f64);

impl<T: Real> Law<T> for ConstantLaw {
    /// The last speed passed to the film, m/s.
    type State = T;

    fn start(&self, _load_n: T) -> T {
        T::ZERO
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    fn set_load(&self, _state: &mut T, _load_n: T) {}

    fn friction(&self, _state: &T, _velocity_m_s: T) -> Friction<T> {
        Friction {
            jump: T::of(self.0),
            smooth: T::ZERO,
        }
    }

    fn advance(&self, state: &mut T, speed_m_s: [T; 3], _rate: T, _dt_s: T) {
        *state = speed_m_s[2];
    }
}
