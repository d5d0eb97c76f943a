//! Control laws before friction compensation, and their gains, from section 6.3 of Cohn (1998).

use crate::plant::Drive;
use crate::real::Real;
use crate::reference::Target;

/// Control law before friction compensation, from section 6.3 of Cohn (1998).
///
/// ```text
/// position   u = -k1 (x - x_ref) - k2 v_hat         s^2 + (a + b k2) s + b k1
/// velocity   u = -g (v_hat - v_ref) + C v_ref       g b = 457 1/s, C = a/b
/// ```
///
/// For the drive of Cohn (1998), [`Drive::THESIS`], the gains are exactly those printed there. For
/// any other drive, the gains result in the same poles of the compensated plant.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum BaseLaw<T> {
    /// Position control: the angle follows the reference.
    Position {
        /// Gain `k1` on the angle error, V/rad.
        angle_v_rad: T,
        /// Gain `k2` on the speed, V s/rad.
        speed_v_s_rad: T,
    },
    /// Velocity control: the speed follows the reference.
    Velocity {
        /// Gain `g` on the speed error, V s/rad.
        speed_v_s_rad: T,
        /// Feedforward gain `C` on the reference speed, V s/rad.
        forward_v_s_rad: T,
    },
}

/// Characteristic polynomial `s^2 + 20 s + 200` of the position loop of Cohn (1998) without
/// friction: poles at -10 +- 10i.
const THESIS_POLYNOMIAL: [f64; 2] = [200.0, 20.0];

impl BaseLaw<f64> {
    /// Position control of Cohn (1998), with `k1` and `k2` from Appendix E.
    pub(crate) const THESIS_POSITION: Self = Self::Position {
        angle_v_rad: 0.43764,
        speed_v_s_rad: -0.25164,
    };

    /// Velocity control of Cohn (1998), with `g` and `C` from Appendix D.
    pub(crate) const THESIS_VELOCITY: Self = Self::Velocity {
        speed_v_s_rad: 1.0,
        forward_v_s_rad: 0.295,
    };

    /// Creates position control of a drive with the poles of Cohn (1998), -10 +- 10i.
    #[must_use]
    pub fn position(drive: &Drive) -> Self {
        if drive.has_same_dynamics(&Drive::THESIS) {
            return Self::THESIS_POSITION;
        }
        Self::with_polynomial(THESIS_POLYNOMIAL, drive)
    }

    /// Creates velocity control of a drive with the loop gain of Cohn (1998), and feedforward of
    /// the reference speed.
    #[must_use]
    pub fn velocity(drive: &Drive) -> Self {
        if drive.has_same_dynamics(&Drive::THESIS) {
            return Self::THESIS_VELOCITY;
        }
        Self::Velocity {
            speed_v_s_rad: Drive::THESIS.input_rad_s2_v / drive.input_rad_s2_v,
            forward_v_s_rad: drive.damping_1_s / drive.input_rad_s2_v,
        }
    }

    /// Creates position control with poles at `w (-1 +- i)/sqrt(2)`, where `w` is `natural_rad_s`.
    #[must_use]
    pub fn pole_placement(natural_rad_s: f64, drive: &Drive) -> Self {
        let w = natural_rad_s;
        Self::with_polynomial([w * w, w * core::f64::consts::SQRT_2], drive)
    }

    /// Creates position control that gives the closed loop the polynomial `s^2 + c1 s + c0`, from
    /// `[c0, c1]`.
    fn with_polynomial([c0, c1]: [f64; 2], drive: &Drive) -> Self {
        Self::Position {
            angle_v_rad: c0 / drive.input_rad_s2_v,
            speed_v_s_rad: (c1 - drive.damping_1_s) / drive.input_rad_s2_v,
        }
    }

    /// Returns both gains: `k1` and `k2`, or `g` and `C`.
    #[must_use]
    pub fn gains(&self) -> [f64; 2] {
        match *self {
            Self::Position {
                angle_v_rad,
                speed_v_s_rad,
            } => [angle_v_rad, speed_v_s_rad],
            Self::Velocity {
                speed_v_s_rad,
                forward_v_s_rad,
            } => [speed_v_s_rad, forward_v_s_rad],
        }
    }

    /// Returns the gain from the reference speed to the output while the shaft follows the
    /// reference, V s/rad.
    ///
    /// It is `C` in velocity control and `-k2` in position control, which uses the measured speed
    /// only.
    #[must_use]
    pub(crate) fn forward_v_s_rad(&self) -> f64 {
        match *self {
            Self::Position { speed_v_s_rad, .. } => -speed_v_s_rad,
            Self::Velocity {
                forward_v_s_rad, ..
            } => forward_v_s_rad,
        }
    }

    /// Converts to another number type.
    #[must_use]
    pub fn cast<T: Real>(&self) -> BaseLaw<T> {
        let [first, second] = self.gains().map(T::of);
        match self {
            Self::Position { .. } => BaseLaw::Position {
                angle_v_rad: first,
                speed_v_s_rad: second,
            },
            Self::Velocity { .. } => BaseLaw::Velocity {
                speed_v_s_rad: first,
                forward_v_s_rad: second,
            },
        }
    }
}

impl<T: Real> BaseLaw<T> {
    /// Returns the control error: controlled quantity minus its reference, rad or rad/s.
    #[inline]
    pub(crate) fn error(&self, target: &Target<T>, angle_rad: T, velocity_rad_s: T) -> T {
        match self {
            Self::Position { .. } => angle_rad - target.value,
            Self::Velocity { .. } => velocity_rad_s - target.value,
        }
    }

    /// Returns the output of the control law, V.
    #[inline]
    pub(crate) fn output_v(&self, target: &Target<T>, angle_rad: T, velocity_rad_s: T) -> T {
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

    /// Returns the reference speed and acceleration of the target, rad/s and rad/s^2.
    #[inline]
    pub(crate) fn reference(&self, target: &Target<T>) -> [T; 2] {
        match self {
            Self::Position { .. } => [target.rate, T::ZERO],
            Self::Velocity { .. } => [target.value, target.rate],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Real and imaginary part of the upper root of the polynomial `s^2 + (a + b k2) s + b k1`.
    fn pole(law: &BaseLaw<f64>, drive: &Drive) -> [f64; 2] {
        let [k1, k2] = law.gains();
        let half = 0.5 * (drive.damping_1_s + drive.input_rad_s2_v * k2);
        [
            -half,
            crate::root::sqrt(drive.input_rad_s2_v * k1 - half * half),
        ]
    }

    #[test]
    fn closed_loop_poles_are_those_requested() {
        let other = Drive::new(10.0, 100.0);
        for (law, drive, side, within) in [
            // The thesis prints five digits.
            (BaseLaw::THESIS_POSITION, Drive::THESIS, 10.0, 1e-3),
            (BaseLaw::position(&other), other, 10.0, 1e-12),
            (
                BaseLaw::pole_placement(30.0, &other),
                other,
                30.0 / 2f64.sqrt(),
                1e-12,
            ),
            (
                BaseLaw::pole_placement(30.0, &Drive::THESIS),
                Drive::THESIS,
                30.0 / 2f64.sqrt(),
                1e-12,
            ),
        ] {
            let [real, imaginary] = pole(&law, &drive);
            assert!((real / -side - 1.0).abs() < within, "{law:?}: {real}");
            assert!(
                (imaginary / side - 1.0).abs() < within,
                "{law:?}: {imaginary}"
            );
        }
    }

    #[test]
    fn gains_of_the_thesis_drive_are_those_printed_in_the_thesis() {
        let volts = Drive::THESIS.with_volts_per_n(0.5).with_limit_v(24.0);
        assert_eq!(BaseLaw::position(&volts), BaseLaw::THESIS_POSITION);
        assert_eq!(BaseLaw::velocity(&volts), BaseLaw::THESIS_VELOCITY);
        // The rule for other drives gives the same gains, to the digits that the thesis prints.
        let near = Drive::new(135.0 + 1e-9, 457.0);
        let [g, c] = BaseLaw::velocity(&near).gains();
        assert!((g - 1.0).abs() < 1e-9 && (c - 0.295).abs() < 5e-4);
        let [k1, k2] = BaseLaw::position(&near).gains();
        assert!((k1 - 0.43764).abs() < 5e-6 && (k2 + 0.25164).abs() < 5e-6);
    }

    #[test]
    fn velocity_loop_has_the_same_stiffness_for_any_drive() {
        let drive = Drive::new(10.0, 100.0);
        let [g, c] = BaseLaw::velocity(&drive).gains();
        assert!((g * drive.input_rad_s2_v - 457.0).abs() < 1e-12);
        // At the wanted speed without friction the correction is zero.
        assert!((c * drive.input_rad_s2_v - drive.damping_1_s).abs() < 1e-12);
        assert_eq!(BaseLaw::velocity(&drive).forward_v_s_rad(), c);
    }
}
