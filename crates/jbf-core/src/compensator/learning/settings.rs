//! Settings of the learning friction compensator.

use super::{Learned, Rule};
use crate::builder::with_fields;
use crate::error::{check, not_negative, positive, Error};

/// Settings of the learning friction compensator [`super::Learning`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Learning rule, determined by the type of control error.
    pub rule: Rule<f64>,
    /// Value of gamma with which the film was created.
    pub gamma: f64,
    /// Change of the learned parameters per step, for a control error of one.
    pub gain: Learned<f64>,
    /// Lower bounds of the learned parameters.
    pub least: Learned<f64>,
    /// Upper bounds of the learned parameters.
    pub most: Learned<f64>,
    /// Voltage that corresponds to a friction coefficient of 1, V; 25.5 V in the programs of Cohn
    /// (1998).
    pub volts: f64,
    /// Journal radius, m.
    pub radius_m: f64,
    /// Time step of the control loop, s.
    pub dt_s: f64,
}

impl Settings {
    /// Creates settings for a learning rule and the initial K0 and gamma of the film.
    ///
    /// The gains are those of Cohn (1998), scaled in proportion to the initial values. The lower
    /// bound of each parameter is a ten-thousandth of its initial value, and the upper bound a
    /// hundred times. The rig determines `volts` (V for a friction coefficient of 1), the journal
    /// radius (m) and the time step of the loop (s).
    #[must_use]
    pub fn new(rule: Rule<f64>, begin: Learned<f64>, volts: f64, radius_m: f64, dt_s: f64) -> Self {
        let (listed, from) = (rule.thesis_gain(), Learned::THESIS);
        let times = |factor: f64| Learned {
            k0: factor * begin.k0,
            gamma: factor * begin.gamma,
        };
        Self {
            rule,
            gamma: begin.gamma,
            gain: Learned {
                k0: listed.k0 / from.k0 * begin.k0,
                gamma: listed.gamma / from.gamma * begin.gamma,
            },
            least: times(1e-4),
            most: times(1e2),
            volts,
            radius_m,
            dt_s,
        }
    }

    with_fields! {
        with_gain => gain: Learned<f64>,
        with_least => least: Learned<f64>,
        with_most => most: Learned<f64>,
    }

    pub(super) fn check(&self, k0: f64) -> Result<(), Error> {
        positive("gamma", self.gamma)?;
        positive("volts", self.volts)?;
        positive("radius_m", self.radius_m)?;
        positive("dt_s", self.dt_s)?;
        not_negative("gain.k0", self.gain.k0)?;
        not_negative("gain.gamma", self.gain.gamma)?;
        let (least, most) = (self.least, self.most);
        for (name, value, low, high) in [
            ("k0", k0, least.k0, most.k0),
            ("gamma", self.gamma, least.gamma, most.gamma),
        ] {
            check(
                low > 0.0 && low <= value && value <= high && high.is_finite(),
                name,
                value,
                "must lie within the bounds of learning, which are positive and finite",
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(rule: Rule<f64>, begin: Learned<f64>) -> Settings {
        Settings::new(rule, begin, 2.9, 0.0127, 0.002)
    }

    #[test]
    fn learning_gains_are_those_of_the_thesis_in_proportion_to_the_start() {
        let listed = settings(Rule::THESIS_POSITION, Learned::THESIS).gain;
        assert!((listed.k0 - 12_500.0).abs() < 1e-9 && (listed.gamma - 0.5).abs() < 1e-15);
        let begin = Learned {
            k0: 2.0 * Learned::THESIS.k0,
            gamma: 3.0 * Learned::THESIS.gamma,
        };
        let gain = settings(Rule::Velocity, begin).gain;
        assert!((gain.k0 - 30_000.0).abs() < 1e-9 && (gain.gamma - 6.0).abs() < 1e-14);
    }

    #[test]
    fn invalid_learning_setting_is_refused_by_name() {
        let good = settings(Rule::Velocity, Learned::THESIS);
        let k0 = Learned::THESIS.k0;
        assert!(good.check(k0).is_ok());
        let negative = |k0, gamma| Learned { k0, gamma };
        for (bad, name) in [
            (Settings { gamma: 0.0, ..good }, "gamma"),
            (
                Settings {
                    volts: f64::NAN,
                    ..good
                },
                "volts",
            ),
            (
                Settings {
                    radius_m: -1.0,
                    ..good
                },
                "radius_m",
            ),
            (Settings { dt_s: 0.0, ..good }, "dt_s"),
            (good.with_gain(negative(-1.0, 0.0)), "gain.k0"),
            (good.with_gain(negative(0.0, f64::NAN)), "gain.gamma"),
            (
                good.with_least(Learned {
                    k0: 2.0 * k0,
                    gamma: 1.0,
                }),
                "k0",
            ),
            (good.with_most(Learned { k0, gamma: 32.0 }), "gamma"),
            (
                good.with_least(Learned {
                    k0: 0.0,
                    gamma: 1.0,
                }),
                "k0",
            ),
        ] {
            assert_eq!(bad.check(k0).expect_err(name).name(), name);
        }
    }
}
