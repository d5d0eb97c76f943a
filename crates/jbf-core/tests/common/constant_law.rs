//! Law with a constant friction coefficient, for comparisons of effects with closed forms.
//!
//! The law is implemented with the public interface only.

use jbf_core::law::Law;
use jbf_core::Friction;
use jbf_core::Real;

/// Law with a constant friction coefficient.
#[derive(Clone, Copy, Debug)]
pub struct ConstantLaw(pub f64);

impl<T: Real> Law<T> for ConstantLaw {
    /// Last speed of the film, m/s, which effects of the lubricant scale.
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
