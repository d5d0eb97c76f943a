//! Coulomb friction observer with an exponent, equation (6.1) of Cohn (1998):
//!
//! ```text
//! F_hat = a_hat sgn(v),  a_hat = z - k_F phi(|v|),  phi(w) = w^p
//! z'    = k_F phi'(|v|) (-a v + b (u - F_hat)) sgn(v)
//! ```
//!
//! Source: Friedland & Park (1992); Friedland & Mentzelopoulou (1992) for the exponent; Cohn
//! (1998), (6.1), who writes (u - F_hat) in units of acceleration.
//!
//! For p < 1 the gain `k_F p w^(p-1)` has a pole at v = 0; for p > 1 it grows without bound with
//! speed. At speeds where the gain would exceed half of the stable value of one step (`k_F phi' b
//! dt = 1/2`), phi is replaced by its tangent. The gain is then bounded, and phi and phi' remain
//! consistent, so that no error accumulates at a reversal. For p = 1 phi does not change. At v = 0
//! exactly, the sign is zero and the estimate is constant.

use crate::error::{check, positive, Error};
use crate::real::Real;

/// Highest speed of any shaft, rad/s; a tangent that extends to this speed would replace phi at all
/// speeds.
const FASTEST_RAD_S: f64 = 1e4;

/// Coulomb friction observer with its gains.
///
/// At each sample, evaluate [`power`](Self::power) at the speed, take the estimate from
/// [`level_v`](Self::level_v), and update it with [`learn`](Self::learn).
/// [`compensator::Coulomb`](crate::compensator::Coulomb) makes these calls.
#[derive(Clone, Copy, Debug)]
pub struct CoulombObserver<T> {
    gain: T,
    exponent: T,
    linear: bool,
    /// Speed at which phi becomes its tangent, rad/s: below it for p < 1, above it for p > 1.
    edge: T,
    edge_slope: T,
    edge_power: T,
    limit_v: T,
    dt_s: T,
}

/// State `z` of the observer, V.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State<T> {
    z_v: T,
}

/// Value of the function phi and its slope at one speed.
#[derive(Clone, Copy, Debug)]
pub struct Power<T> {
    value: T,
    slope: T,
}

impl<T: Real> CoulombObserver<T> {
    /// Creates a Coulomb friction observer.
    ///
    /// - `gain`: `k_F`, in the units of Cohn (1998), V per (rad/s)^p. With p = 1 the estimate follows
    ///   the friction with a time constant of `1/(k_F b)`.
    /// - `exponent`: `p`.
    /// - `input_rad_s2_v`: input gain `b` of the plant, rad/s^2/V.
    /// - `limit_v`: largest friction level that may be learned, V.
    /// - `dt_s`: time step of the control loop, s.
    ///
    /// # Errors
    /// All must be positive and finite, and `p` at most 4. With p = 1, `k_F b dt` must be below 1.
    /// With p < 1, the gain must be stable at a speed that a shaft can reach.
    pub fn new(
        gain: f64,
        exponent: f64,
        input_rad_s2_v: f64,
        limit_v: f64,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("gain", gain)?;
        positive("exponent", exponent)?;
        positive("input_rad_s2_v", input_rad_s2_v)?;
        positive("limit_v", limit_v)?;
        positive("dt_s", dt_s)?;
        check(exponent <= 4.0, "exponent", exponent, "must be at most 4")?;
        let linear = exponent == 1.0;
        check(
            !linear || gain * input_rad_s2_v * dt_s < 1.0,
            "gain",
            gain,
            "is too large for the time step: k_F b dt must stay below 1",
        )?;
        let steepest = 0.5 / (gain * input_rad_s2_v * dt_s);
        let edge = if linear {
            0.0
        } else {
            libm::pow(steepest / exponent, 1.0 / (exponent - 1.0))
        };
        check(
            exponent >= 1.0 || edge < FASTEST_RAD_S,
            "gain",
            gain,
            "is too large for the time step: k_F phi' b dt must stay below one half at every speed",
        )?;
        Ok(Self {
            gain: T::of(gain),
            exponent: T::of(exponent),
            linear,
            edge: T::of(edge),
            edge_slope: T::of(steepest),
            edge_power: T::of(libm::pow(edge, exponent)),
            limit_v: T::of(limit_v),
            dt_s: T::of(dt_s),
        })
    }

    /// Evaluates phi and its slope at a speed, rad/s.
    #[inline]
    #[must_use]
    pub fn power(&self, velocity_rad_s: T) -> Power<T> {
        let w = velocity_rad_s.abs();
        if self.linear {
            return Power {
                value: w,
                slope: T::ONE,
            };
        }
        if (w < self.edge) == (self.exponent < T::ONE) {
            return Power {
                value: self.edge_power + self.edge_slope * (w - self.edge),
                slope: self.edge_slope,
            };
        }
        if w <= T::ZERO || !w.is_finite() {
            return Power {
                value: T::ZERO,
                slope: T::ZERO,
            };
        }
        let value = w.powf(self.exponent);
        Power {
            value,
            slope: self.exponent * value / w,
        }
    }

    /// Returns the estimated friction level `a_hat`, V.
    #[inline]
    #[must_use]
    pub fn level_v(&self, state: &State<T>, power: &Power<T>) -> T {
        state.z_v - self.gain * power.value
    }

    /// Updates the estimate of the friction level in one step.
    ///
    /// `free_rad_s2` is the acceleration (rad/s^2) of the plant without the compensated friction,
    /// `-a v + b u` with u before compensation. The estimate then follows the friction at the rate
    /// `k_F phi' b`.
    #[inline]
    pub fn learn(&self, state: &mut State<T>, power: &Power<T>, velocity_rad_s: T, free_rad_s2: T) {
        state.z_v += self.dt_s * self.gain * power.slope * free_rad_s2 * velocity_rad_s.sign();
        let least = self.gain * power.value;
        state.z_v = state
            .z_v
            .max(least - self.limit_v)
            .min(least + self.limit_v);
    }

    /// Creates the state at rest for a friction level (V), limited to the bound.
    #[must_use]
    pub fn learned(&self, level_v: T) -> State<T> {
        let rest = self.power(T::ZERO);
        State {
            z_v: level_v.max(-self.limit_v).min(self.limit_v) + self.gain * rest.value,
        }
    }
}
