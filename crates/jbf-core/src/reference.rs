//! Reference of the control loop: sine, triangle and square wave as in the programs of Cohn (1998).
//!
//! ```text
//! sine      (high + low + (high - low) sin(w t - p)) / 2,  p = asin((high + low)/(high - low))
//!           where the wave passes zero (it then starts there), else pi/2 (it starts at low)
//! triangle  from low up to high and back, starting at low
//! square    high in the first half of a period, low in the second
//! ```
//!
//! Source: Cohn (1998), Appendices D and E.

use crate::error::{check, finite, positive, Error};
use core::f64::consts::{FRAC_PI_2, TAU};

/// Waveform of a periodic reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Wave {
    /// Sine wave.
    Sine,
    /// Triangle wave.
    Triangle,
    /// Square wave.
    Square,
}

/// Value of a reference at one instant, with its rate of change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Target<T> {
    /// Reference value: rad for position control, rad/s for velocity control.
    pub value: T,
    /// Rate of change of the value, per second; zero at a jump.
    pub rate: T,
}

/// Periodic reference of a control loop, computed in double precision.
///
/// A microcontroller takes its values from a table or from a host.
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    wave: Wave,
    low: f64,
    high: f64,
    frequency_rad_s: f64,
    phase_rad: f64,
}

impl Reference {
    /// Creates a wave between `low` and `high` at a frequency (rad/s), with the phase of the
    /// programs of Cohn (1998).
    ///
    /// # Errors
    /// The frequency must be positive, `high` above `low`, both finite.
    pub fn new(wave: Wave, low: f64, high: f64, frequency_rad_s: f64) -> Result<Self, Error> {
        positive("frequency_rad_s", frequency_rad_s)?;
        finite("low", low)?;
        check(
            high.is_finite() && high > low,
            "high",
            high,
            "must be finite and above low",
        )?;
        let phase_rad = if high * low < 0.0 {
            libm::asin((high + low) / (high - low))
        } else {
            FRAC_PI_2
        };
        Ok(Self {
            wave,
            low,
            high,
            frequency_rad_s,
            phase_rad,
        })
    }

    /// Returns the period, s.
    pub(crate) fn period_s(&self) -> f64 {
        TAU / self.frequency_rad_s
    }

    /// Returns the value and its rate of change at a time, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Target<f64> {
        let (span, period) = (self.high - self.low, self.period_s());
        let phase = time_s - libm::floor(time_s / period) * period;
        match self.wave {
            Wave::Sine => {
                let angle = self.frequency_rad_s * time_s - self.phase_rad;
                Target {
                    value: (self.high + self.low + span * libm::sin(angle)) / 2.0,
                    rate: span * self.frequency_rad_s * libm::cos(angle) / 2.0,
                }
            }
            Wave::Triangle => {
                let slope = 2.0 * span / period;
                if phase > period / 2.0 {
                    Target {
                        value: self.high - slope * (phase - period / 2.0),
                        rate: -slope,
                    }
                } else {
                    Target {
                        value: self.low + slope * phase,
                        rate: slope,
                    }
                }
            }
            Wave::Square => Target {
                value: if phase > period / 2.0 {
                    self.low
                } else {
                    self.high
                },
                rate: 0.0,
            },
        }
    }
}
