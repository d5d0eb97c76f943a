//! Learning rule for an error: the ratchet of the thesis, Figure 6.1.

use super::Learned;
use crate::compensator::Sense;
use crate::real::Real;

/// Meaning of the error, which determines the learning rule.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Rule<T> {
    /// The error is a speed.
    Velocity,
    /// The error is an angle. It is clipped to `clip_rad`, and nothing is learned beyond
    /// `gate_rad`.
    Position {
        /// Gate, rad; 0.8 rad in the thesis.
        gate_rad: T,
        /// Clip, rad; 0.3 rad in the thesis.
        clip_rad: T,
    },
}

impl Rule<f64> {
    /// Position-control rule of the thesis.
    pub const THESIS_POSITION: Self = Self::Position {
        gate_rad: 0.8,
        clip_rad: 0.3,
    };

    /// Learning gains of the thesis per step of 2 ms, for the initial values of its programs.
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
    /// Direction and size of the change of a parameter by the error: `-e sgn(v)` in the thesis.
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

    /// Sign of the friction in the output.
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
