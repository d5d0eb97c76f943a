//! Learning rules of the learning compensator for a speed error and an angle error, Figure 6.1 of
//! Cohn (1998).

use super::Learned;
use crate::compensator::Input;
use crate::real::Real;

/// Learning rule, determined by the type of control error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rule<T> {
    /// The control error is a speed.
    Velocity,
    /// The control error is an angle. The error is clipped to `clip_rad`, and errors beyond
    /// `gate_rad` are ignored.
    Position {
        /// Angle error from which nothing is learned, rad; 0.8 rad in Cohn (1998).
        gate_rad: T,
        /// Largest angle error in the rule, rad; 0.3 rad in Cohn (1998).
        clip_rad: T,
    },
}

impl Rule<f64> {
    /// Rule for position control of Cohn (1998).
    pub const THESIS_POSITION: Self = Self::Position {
        gate_rad: 0.8,
        clip_rad: 0.3,
    };

    /// Learning gains of Cohn (1998) per step of 2 ms, for the initial values of its programs.
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

    pub(super) fn cast<T: Real>(&self) -> Rule<T> {
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
    /// Change of a learned parameter for a gain of one, with its sign; for a speed error `-e
    /// sgn(v)` as in Cohn (1998).
    #[inline]
    pub(super) fn lesson(&self, input: &Input<T>) -> T {
        let (v, e) = (input.velocity_rad_s, input.error);
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

    /// Sign of the friction in the output of the compensator.
    #[inline]
    pub(super) fn direction(&self, input: &Input<T>) -> T {
        match *self {
            Self::Velocity => input.velocity_rad_s.sign(),
            Self::Position { .. } if input.error > T::ZERO => -T::ONE,
            Self::Position { .. } => T::ONE,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lesson(rule: Rule<f64>, velocity_rad_s: f64, error: f64) -> f64 {
        rule.lesson(&Input {
            velocity_rad_s,
            error,
            ..Input::default()
        })
    }

    #[test]
    fn velocity_rule_raises_friction_if_the_shaft_is_too_slow() {
        // Too slow forwards, too slow backwards; an error of the opposite sign has the opposite
        // effect.
        assert_eq!(lesson(Rule::Velocity, 1.0, -0.5), 0.5);
        assert_eq!(lesson(Rule::Velocity, -1.0, 0.5), 0.5);
        assert_eq!(lesson(Rule::Velocity, 1.0, 0.5), -0.5);
        assert_eq!(lesson(Rule::Velocity, 0.0, 0.5), 0.0);
    }

    #[test]
    fn position_rule_raises_friction_towards_the_target_and_lowers_it_away_from_it() {
        let rule = Rule::THESIS_POSITION;
        assert_eq!(lesson(rule, 1.0, -0.2), 0.2);
        assert_eq!(lesson(rule, 0.0, -0.2), 0.2);
        assert_eq!(lesson(rule, -1.0, -0.2), -0.2);
        // The error is clipped, and ignored beyond the gate.
        assert_eq!(lesson(rule, 1.0, -0.5), 0.3);
        assert_eq!(lesson(rule, 1.0, -0.8), 0.0);
    }
}
