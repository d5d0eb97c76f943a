//! Imposed surface speed as a function of time.

use crate::error::{finite, not_negative, positive, Error};
use core::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI, TAU};

/// Imposed surface speed as a function of time, with the instants at which it is not smooth.
pub trait Excitation {
    /// Returns the signed surface speed at a time, m/s.
    fn velocity_m_s(&self, time_s: f64) -> f64;

    /// Returns the rate of change of the speed at a time, m/s^2; at a kink, the value after it.
    fn acceleration_m_s2(&self, time_s: f64) -> f64;

    /// Returns the first instant after `time_s` at which the speed changes sign or one of its
    /// derivatives jumps, s; infinity if there is none.
    ///
    /// Integration steps end at this instant. A change of sign that is not reported is found if a
    /// step ends after it.
    fn next_kink_s(&self, time_s: f64) -> f64;
}

/// Biased sine `U = bias + amplitude sin(omega t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    amplitude_m_s: f64,
    omega_rad_s: f64,
    bias_m_s: f64,
    /// Phase of the first zero crossing from negative to positive speed, rad; `None` if the speed
    /// never changes sign.
    upward_rad: Option<f64>,
}

impl Sine {
    /// Creates the speed `U = amplitude sin(omega t)`.
    ///
    /// # Errors
    /// The amplitude must be finite and not negative, the frequency positive and finite.
    pub fn new(amplitude_m_s: f64, omega_rad_s: f64) -> Result<Self, Error> {
        Self::with_bias(amplitude_m_s, omega_rad_s, 0.0)
    }

    /// Creates the speed `U = bias + amplitude sin(omega t)`.
    ///
    /// # Errors
    /// As [`Sine::new`]; the bias must be finite.
    pub fn with_bias(amplitude_m_s: f64, omega_rad_s: f64, bias_m_s: f64) -> Result<Self, Error> {
        not_negative("amplitude_m_s", amplitude_m_s)?;
        positive("omega_rad_s", omega_rad_s)?;
        finite("bias_m_s", bias_m_s)?;
        let turns = libm::fabs(bias_m_s) < amplitude_m_s;
        Ok(Self {
            amplitude_m_s,
            omega_rad_s,
            bias_m_s,
            upward_rad: turns.then(|| libm::asin(-bias_m_s / amplitude_m_s)),
        })
    }
}

impl Excitation for Sine {
    #[inline]
    fn velocity_m_s(&self, time_s: f64) -> f64 {
        self.bias_m_s + self.amplitude_m_s * sine(self.omega_rad_s * time_s)
    }

    #[inline]
    fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        self.amplitude_m_s * self.omega_rad_s * sine(self.omega_rad_s * time_s + FRAC_PI_2)
    }

    fn next_kink_s(&self, time_s: f64) -> f64 {
        let Some(upward) = self.upward_rad else {
            return f64::INFINITY;
        };
        let phase = self.omega_rad_s * time_s;
        // A kink on which a step has just landed is not the next one.
        let margin = 1e-9 + 1e-15 * libm::fabs(phase);
        let after = |zero: f64| {
            let turns = libm::floor((phase + margin - zero) / TAU) + 1.0;
            (zero + TAU * turns) / self.omega_rad_s
        };
        after(upward).min(after(PI - upward))
    }
}

/// Branch-free sine, so that samples are computed in the lanes of vector registers.
///
/// The integration of a trajectory evaluates the sine more often than any other function. It
/// consists of sums and products only and returns the same bits on every target. The error is below
/// 4e-16. Beyond a million turns, the library function is used.
#[inline]
fn sine(x: f64) -> f64 {
    // Adding this constant rounds to a whole number, whose last bit is then the last bit of the
    // sum.
    const ROUNDER: f64 = 6755399441055744.0;
    // pi in three parts; the first two leave room for an exact product with a whole number.
    const PI_PARTS: [f64; 3] = [
        3.141592651605606,
        1.9841871479187034e-09,
        1.1442377452219664e-17,
    ];
    // (-1)^k / (2k+1)!; the truncation error is below 1e-18 for |r| up to pi/2.
    const TAYLOR: [f64; 10] = [
        -1.0 / 6.0,
        1.0 / 120.0,
        -1.0 / 5040.0,
        1.0 / 362880.0,
        -1.0 / 39916800.0,
        1.0 / 6227020800.0,
        -1.0 / 1307674368000.0,
        1.0 / 355687428096000.0,
        -1.0 / 121645100408832000.0,
        1.0 / 51090942171709440000.0,
    ];
    if libm::fabs(x) > 6e6 {
        return libm::sin(x);
    }
    let shifted = x * FRAC_1_PI + ROUNDER;
    let turns = shifted - ROUNDER;
    let r = ((x - turns * PI_PARTS[0]) - turns * PI_PARTS[1]) - turns * PI_PARTS[2];
    let z = r * r;
    // Evaluation in pairs (Estrin): a third of the latency of sequential sums.
    let (z2, pair) = (z * z, |i: usize| TAYLOR[i] + z * TAYLOR[i + 1]);
    let z4 = z2 * z2;
    let sum = (pair(0) + z2 * pair(2)) + z4 * ((pair(4) + z2 * pair(6)) + z4 * pair(8));
    let value = r + r * z * sum;
    f64::from_bits(value.to_bits() ^ (shifted.to_bits() << 63))
}

/// Smooth surface speed given by two functions, with its rate of change; changes of sign are found
/// during integration.
#[derive(Clone, Copy, Debug)]
pub struct Function<V, A> {
    /// Speed (m/s) as a function of time (s).
    pub velocity_m_s: V,
    /// Rate of change of the speed (m/s^2) as a function of time (s).
    pub acceleration_m_s2: A,
}

impl<V: Fn(f64) -> f64, A: Fn(f64) -> f64> Excitation for Function<V, A> {
    fn velocity_m_s(&self, time_s: f64) -> f64 {
        (self.velocity_m_s)(time_s)
    }
    fn acceleration_m_s2(&self, time_s: f64) -> f64 {
        (self.acceleration_m_s2)(time_s)
    }
    fn next_kink_s(&self, _time_s: f64) -> f64 {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_agrees_with_libm_to_rounding() {
        for i in -400_000_i32..400_000 {
            let x = 0.001_234_567 * f64::from(i) * (1.0 + 1e-3 * f64::from(i.abs()));
            let error = (sine(x) - libm::sin(x)).abs();
            assert!(error < 4e-16, "{x} {error:e}");
        }
        assert!(sine(f64::NAN).is_nan());
    }

    #[test]
    fn kinks_of_a_biased_sine_are_its_zeros() {
        let motion = Sine::with_bias(0.1, 3.0, 0.05).expect("valid");
        let mut t = 0.0;
        for _ in 0..1000 {
            let next = motion.next_kink_s(t);
            assert!(next > t + 0.1 && motion.velocity_m_s(next).abs() < 1e-12);
            let side = motion.velocity_m_s(0.5 * (t + next));
            for s in [0.01, 0.3, 0.9, 0.99] {
                let within = motion.velocity_m_s(t + s * (next - t));
                assert!(t == 0.0 || within * side > 0.0);
            }
            t = next;
        }
        let one_way = Sine::with_bias(0.1323, 0.0055, 0.1323).expect("valid");
        assert_eq!(one_way.next_kink_s(0.0), f64::INFINITY);
    }
}
