//! The thesis's two control laws, section 6.3:
//!
//! ```text
//! position   u = -k1 (x - x_ref) - k2 v_hat
//! velocity   u = -g (v_hat - v_ref) + C v_ref
//! ```

use crate::real::Real;
use crate::reference::Target;

/// A control law before compensation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BaseLaw<T> {
    /// Angle follows the reference.
    Position {
        /// `k1`, V/rad.
        angle_v_rad: T,
        /// `k2`, V s/rad.
        speed_v_s_rad: T,
    },
    /// Speed follows the reference.
    Velocity {
        /// `g`, V s/rad.
        speed_v_s_rad: T,
        /// `C`, V s/rad.
        forward_v_s_rad: T,
    },
}

impl<T: Real> BaseLaw<T> {
    /// The thesis's position control: poles at -10 +- 10i.
    pub fn thesis_position() -> Self {
        Self::Position {
            angle_v_rad: T::of(0.43764),
            speed_v_s_rad: T::of(-0.25164),
        }
    }

    /// The thesis's velocity control.
    pub fn thesis_velocity() -> Self {
        Self::Velocity {
            speed_v_s_rad: T::of(1.0),
            forward_v_s_rad: T::of(0.295),
        }
    }

    /// Position control with both poles of `s^2 + (a + b k2) s + b k1` at
    /// `w (-1 +- i)/sqrt(2)`.
    pub fn placed(natural_rad_s: f64, damping_1_s: f64, input_rad_s2_v: f64) -> Self {
        let w = natural_rad_s;
        Self::Position {
            angle_v_rad: T::of(w * w / input_rad_s2_v),
            speed_v_s_rad: T::of((w * core::f64::consts::SQRT_2 - damping_1_s) / input_rad_s2_v),
        }
    }

    /// What is controlled minus what is wanted.
    #[inline]
    pub fn error(&self, target: &Target<T>, angle_rad: T, velocity_rad_s: T) -> T {
        match self {
            Self::Position { .. } => angle_rad - target.value,
            Self::Velocity { .. } => velocity_rad_s - target.value,
        }
    }

    /// The control voltage, V.
    #[inline]
    pub fn output_v(&self, target: &Target<T>, angle_rad: T, velocity_rad_s: T) -> T {
        match *self {
            Self::Position {
                angle_v_rad,
                speed_v_s_rad,
            } => -angle_v_rad * (angle_rad - target.value) - speed_v_s_rad * velocity_rad_s,
            Self::Velocity {
                speed_v_s_rad,
                forward_v_s_rad,
            } => -speed_v_s_rad * (velocity_rad_s - target.value) + forward_v_s_rad * target.value,
        }
    }

    /// Speed and acceleration that the target asks for, rad/s and rad/s^2.
    #[inline]
    pub fn wanted(&self, target: &Target<T>) -> [T; 2] {
        match self {
            Self::Position { .. } => [target.rate, T::ZERO],
            Self::Velocity { .. } => [target.value, target.rate],
        }
    }
}
