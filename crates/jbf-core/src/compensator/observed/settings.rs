//! Settings of the compensator with a friction model that an observer corrects.

use crate::builder::with_fields;
use crate::control_law::BaseLaw;
use crate::error::{check, finite, not_negative, positive, Error};
use crate::plant::Drive;

/// Settings of the compensator [`super::Observed`], in SI units.
///
/// `jbf control tune` computes them from a model and the resolution of the encoder. Its rules are
/// good first values: a bandwidth of 0.12 divided by the time step, or less if the output is noisy;
/// a `learning_1_s` of a thirtieth of the bandwidth; a `level_limit_v` of the friction level, and a
/// `rest_limit_v` of the friction level and a tenth of the largest voltage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Damping `a` of the plant without the friction of the model, 1/s; zero for a drive with a
    /// torque controller.
    pub damping_1_s: f64,
    /// Input gain `b` of the plant, rad/s^2/V.
    pub input_rad_s2_v: f64,
    /// Bandwidth that sets the poles of the observer, rad/s.
    pub bandwidth_rad_s: f64,
    /// Rate at which a constant disturbance is attributed to friction, 1/s.
    pub learning_1_s: f64,
    /// Largest correction of the friction level, V, in either direction.
    pub level_limit_v: f64,
    /// Largest disturbance in addition to friction, V, in either direction.
    pub rest_limit_v: f64,
    /// Speed below which the shaft is considered slow, rad/s; a few times the noise of the speed
    /// estimate.
    pub slow_rad_s: f64,
    /// Desired speed per angle error, 1/s; zero in velocity control.
    pub approach_1_s: f64,
    /// Fraction of the friction level that is output while the shaft is slow; below one, limit
    /// cycles (hunting) cannot occur.
    pub breakaway: f64,
    /// Additional feedback of the angle error, V/rad, on top of the control law.
    ///
    /// The compensated plant is known and therefore tolerates a higher gain.
    pub stiffer_v_rad: f64,
    /// Additional feedback of the speed error, V s/rad, on top of the control law.
    pub stiffer_v_s_rad: f64,
    /// Gain of the control law from the reference speed to the output, V s/rad:
    /// `C` in velocity control and `-k2` in position control (see [`BaseLaw`]).
    pub law_forward_v_s_rad: f64,
    /// Time step of the control loop, s.
    pub dt_s: f64,
}

impl Settings {
    /// Creates settings for a drive from the bandwidth of the observer (rad/s), the speed below
    /// which the shaft is considered slow (rad/s), and the time step of the control loop (s).
    ///
    /// All limits are zero, so that no correction is made until limits are set. No control law is
    /// assumed until [`Settings::with_control_law`] sets one.
    #[must_use]
    pub const fn new(drive: &Drive, bandwidth_rad_s: f64, slow_rad_s: f64, dt_s: f64) -> Self {
        Self {
            damping_1_s: drive.damping_1_s,
            input_rad_s2_v: drive.input_rad_s2_v,
            bandwidth_rad_s,
            learning_1_s: 0.0,
            level_limit_v: 0.0,
            rest_limit_v: 0.0,
            slow_rad_s,
            approach_1_s: 0.0,
            breakaway: 1.0,
            stiffer_v_rad: 0.0,
            stiffer_v_s_rad: 0.0,
            law_forward_v_s_rad: 0.0,
            dt_s,
        }
    }

    with_fields! {
        with_learning_1_s => learning_1_s: f64,
        with_level_limit_v => level_limit_v: f64,
        with_rest_limit_v => rest_limit_v: f64,
        with_approach_1_s => approach_1_s: f64,
        with_breakaway => breakaway: f64,
        with_stiffer_v_rad => stiffer_v_rad: f64,
        with_stiffer_v_s_rad => stiffer_v_s_rad: f64,
        with_law_forward_v_s_rad => law_forward_v_s_rad: f64,
    }

    /// Adapts the settings to a control law.
    ///
    /// A position loop gets additional stiffness for the natural frequency `loop_rad_s`, and the
    /// rate of approach to its target is a third of it. The frequency has no effect on a velocity
    /// loop.
    #[must_use]
    pub fn with_control_law(mut self, law: &BaseLaw<f64>, loop_rad_s: f64) -> Self {
        self.law_forward_v_s_rad = law.forward_v_s_rad();
        if let BaseLaw::Position { .. } = law {
            let drive = Drive::new(self.damping_1_s, self.input_rad_s2_v);
            let [wanted, has] = [
                BaseLaw::pole_placement(loop_rad_s, &drive).gains(),
                law.gains(),
            ];
            self.stiffer_v_rad = wanted[0] - has[0];
            self.stiffer_v_s_rad = wanted[1] - has[1];
            self.approach_1_s = loop_rad_s / 3.0;
        } else {
            self.stiffer_v_rad = 0.0;
            self.stiffer_v_s_rad = 0.0;
            self.approach_1_s = 0.0;
        }
        self
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        not_negative("damping_1_s", self.damping_1_s)?;
        positive("input_rad_s2_v", self.input_rad_s2_v)?;
        positive("bandwidth_rad_s", self.bandwidth_rad_s)?;
        positive("slow_rad_s", self.slow_rad_s)?;
        positive("dt_s", self.dt_s)?;
        not_negative("learning_1_s", self.learning_1_s)?;
        not_negative("level_limit_v", self.level_limit_v)?;
        not_negative("rest_limit_v", self.rest_limit_v)?;
        not_negative("approach_1_s", self.approach_1_s)?;
        not_negative("breakaway", self.breakaway)?;
        finite("stiffer_v_rad", self.stiffer_v_rad)?;
        finite("stiffer_v_s_rad", self.stiffer_v_s_rad)?;
        finite("law_forward_v_s_rad", self.law_forward_v_s_rad)?;
        check(
            self.learning_1_s * self.dt_s < 1.0,
            "learning_1_s",
            self.learning_1_s,
            "is too large for the time step",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Settings = Settings::new(&Drive::THESIS, 60.0, 0.05, 0.002);

    #[test]
    fn position_loop_gets_poles_of_the_requested_frequency() {
        let law = BaseLaw::position(&Drive::THESIS);
        let s = PLAIN.with_control_law(&law, 30.0);
        // Both feedbacks together have poles of natural frequency 30 rad/s.
        let [k1, k2] = law.gains();
        let (c0, c1) = (
            457.0 * (k1 + s.stiffer_v_rad),
            135.0 + 457.0 * (k2 + s.stiffer_v_s_rad),
        );
        assert!((c0 - 900.0).abs() < 1e-9 && (c1 - 30.0 * 2f64.sqrt()).abs() < 1e-9);
        assert_eq!((s.approach_1_s, s.law_forward_v_s_rad), (10.0, 0.25164));
    }

    #[test]
    fn velocity_loop_gets_no_additional_stiffness() {
        let s = PLAIN.with_control_law(&BaseLaw::velocity(&Drive::THESIS), 30.0);
        assert_eq!(s, PLAIN.with_law_forward_v_s_rad(0.295));
    }

    #[test]
    fn invalid_observer_setting_is_refused_by_name() {
        assert!(PLAIN.check().is_ok());
        for (bad, name) in [
            (
                Settings::new(&Drive::new(-1.0, 1.0), 60.0, 0.05, 0.002),
                "damping_1_s",
            ),
            (
                Settings::new(&Drive::new(1.0, -1.0), 60.0, 0.05, 0.002),
                "input_rad_s2_v",
            ),
            (
                Settings::new(&Drive::THESIS, f64::NAN, 0.05, 0.002),
                "bandwidth_rad_s",
            ),
            (
                Settings::new(&Drive::THESIS, 60.0, 0.0, 0.002),
                "slow_rad_s",
            ),
            (
                Settings::new(&Drive::THESIS, 60.0, 0.05, f64::INFINITY),
                "dt_s",
            ),
            (PLAIN.with_learning_1_s(-1.0), "learning_1_s"),
            (PLAIN.with_learning_1_s(500.0), "learning_1_s"),
            (PLAIN.with_level_limit_v(-1.0), "level_limit_v"),
            (PLAIN.with_rest_limit_v(f64::NAN), "rest_limit_v"),
            (PLAIN.with_approach_1_s(-1.0), "approach_1_s"),
            (PLAIN.with_breakaway(f64::INFINITY), "breakaway"),
            (PLAIN.with_stiffer_v_rad(f64::NAN), "stiffer_v_rad"),
            (PLAIN.with_stiffer_v_s_rad(f64::NAN), "stiffer_v_s_rad"),
            (
                PLAIN.with_law_forward_v_s_rad(f64::NAN),
                "law_forward_v_s_rad",
            ),
        ] {
            assert_eq!(bad.check().expect_err(name).name(), name);
        }
    }
}
