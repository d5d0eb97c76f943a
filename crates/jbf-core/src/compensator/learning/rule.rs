//! What an error teaches: the thesis's ratchet, Figure 6.1.

use super::Learned;
use crate::compensator::Sense;
use crate::real::Real;

/// What the error means, and so how it teaches.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rule<T> {
    /// Error of speed.
    Velocity,
    /// Error of angle: no learning beyond `gate_rad`, the error clipped to `clip_rad`.
    Position {
        /// 0.8 rad in the thesis.
        gate_rad: T,
        /// 0.3 rad in the thesis.
        clip_rad: T,
    },
}

impl Rule<f64> {
    /// The thesis's rule of position control.
    pub const THESIS_POSITION: Self = Self::Position {
        gate_rad: 0.8,
        clip_rad: 0.3,
    };

    /// The thesis's learning gains a step of 2 ms, for what its programs start from.
    pub(super) fn thesis_gain(&self) -> Learned<f64> {
        match self {
            Self::Velocity => Learned {
                k0: 15_000.0,
                gamma: 2.0,
            },
            Self::Position { .. } => Learned {
                k0: 12_500.0,
                gamma: 0.5,
            },
        }
    }

    pub(super) fn lift<T: Real>(&self) -> Rule<T> {
        match *self {
            Self::Velocity => Rule::Velocity,
            Self::Position { gate_rad, clip_rad } => Rule::Position {
                gate_rad: T::of(gate_rad),
                clip_rad: T::of(clip_rad),
            },
        }
    }
}

impl<T: Real> Rule<T> {
    /// Which way, and how far, the error pushes a parameter: the thesis's `-e sgn(v)`.
    #[inline]
    pub(super) fn lesson(&self, sense: &Sense<T>) -> T {
        let (v, e) = (sense.velocity_rad_s, sense.error);
        match *self {
            Self::Velocity => -e * v.sign(),
            Self::Position { gate_rad, clip_rad } => {
                let size = e.abs();
                if size >= gate_rad {
                    T::ZERO
                } else if v * e > T::ZERO {
                    -size.min(clip_rad)
                } else {
                    size.min(clip_rad)
                }
            }
        }
    }

    /// Sign of the friction in the sum.
    #[inline]
    pub(super) fn direction(&self, sense: &Sense<T>) -> T {
        match *self {
            Self::Velocity => sense.velocity_rad_s.sign(),
            Self::Position { .. } if sense.error > T::ZERO => -T::ONE,
            Self::Position { .. } => T::ONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lesson(rule: Rule<f64>, velocity_rad_s: f64, error: f64) -> f64 {
        rule.lesson(&Sense {
            velocity_rad_s,
            error,
            ..Sense::default()
        })
    }

    #[test]
    fn in_velocity_control_the_shaft_that_is_slow_has_more_friction() {
        // Too slow forwards, too slow backwards; too fast is the other way round.
        assert_eq!(lesson(Rule::Velocity, 1.0, -0.5), 0.5);
        assert_eq!(lesson(Rule::Velocity, -1.0, 0.5), 0.5);
        assert_eq!(lesson(Rule::Velocity, 1.0, 0.5), -0.5);
        assert_eq!(lesson(Rule::Velocity, 0.0, 0.5), 0.0);
    }

    #[test]
    fn in_position_control_it_learns_up_towards_the_goal_and_down_away_from_it() {
        let rule = Rule::THESIS_POSITION;
        assert_eq!(lesson(rule, 1.0, -0.2), 0.2);
        assert_eq!(lesson(rule, 0.0, -0.2), 0.2);
        assert_eq!(lesson(rule, -1.0, -0.2), -0.2);
        // Clipped, and beyond the gate not at all.
        assert_eq!(lesson(rule, 1.0, -0.5), 0.3);
        assert_eq!(lesson(rule, 1.0, -0.8), 0.0);
    }
}
