//! The Coulomb friction observer with an exponent, (6.1):
//!
//! ```text
//! F_hat = a_hat sgn(v),  a_hat = z - k_F phi(|v|),  phi(w) = w^p
//! z'    = k_F phi'(|v|) (-a v + b (u - F_hat)) sgn(v)
//! ```
//!
//! Source: Friedland & Park (1992); Friedland & Mentzelopoulou (1992) for the exponent; Cohn
//! (1998), (6.1). The thesis writes (u - F_hat) in units of acceleration.
//!
//! For p < 1 the gain `k_F p w^(p-1)` has a pole at v = 0, for p > 1 it grows without bound with
//! speed. Where the gain would pass half of what one step can take (`k_F phi' b dt = 1/2`), phi
//! goes on as its own tangent: the gain is then bounded, and phi and phi' still belong together,
//! so that no error builds up on the way through zero. With p = 1 this never acts. At v = 0
//! exactly the sign is zero and the observer holds.

use crate::error::{check, positive, Error};
use crate::real::Real;

/// No shaft turns faster, rad/s: a guard that reached as far would take phi's place everywhere.
const FASTEST_RAD_S: f64 = 1e4;

/// Gains of the Coulomb observer.
#[derive(Clone, Copy, Debug)]
pub struct CoulombObserver<T> {
    gain: T,
    exponent: T,
    linear: bool,
    /// Where phi becomes its tangent: below it for p < 1, above it for p > 1.
    edge: T,
    edge_slope: T,
    edge_power: T,
    limit_v: T,
    dt_s: T,
}

/// `z`, in volts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State<T> {
    z_v: T,
}

/// phi and its slope at one speed.
#[derive(Clone, Copy, Debug)]
pub struct Power<T> {
    value: T,
    slope: T,
}

impl<T: Real> CoulombObserver<T> {
    /// Gain `k_F` (in the thesis's units, V per (rad/s)^p), exponent `p`, the plant's input gain
    /// `b` (rad/s^2/V), and the most that may be learned, V.
    ///
    /// # Errors
    /// All must be positive and finite; `p` at most 4; with p = 1 `k_F b dt` below 1, with p < 1 a
    /// gain that some speed of a shaft bears.
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
            "is too large for the time step: k_F phi' b dt would pass one half at every speed",
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

    /// phi at a speed, rad/s.
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

    /// The level `a_hat`, V.
    #[inline]
    #[must_use]
    pub fn level_v(&self, state: &State<T>, power: &Power<T>) -> T {
        state.z_v - self.gain * power.value
    }

    /// Learn from one step: the acceleration (rad/s^2) that the plant would have without the
    /// friction that is compensated, `-a v + b u` with u before compensation. The estimate then
    /// follows the friction with the rate `k_F phi' b`.
    #[inline]
    pub fn learn(&self, state: &mut State<T>, power: &Power<T>, velocity_rad_s: T, free_rad_s2: T) {
        state.z_v += self.dt_s * self.gain * power.slope * free_rad_s2 * velocity_rad_s.sign();
        let least = self.gain * power.value;
        state.z_v = state
            .z_v
            .max(least - self.limit_v)
            .min(least + self.limit_v);
    }

    /// A state that has learned a level, V, at rest; held within the limit.
    #[must_use]
    pub fn learned(&self, level_v: T) -> State<T> {
        let rest = self.power(T::ZERO);
        State {
            z_v: level_v.max(-self.limit_v).min(self.limit_v) + self.gain * rest.value,
        }
    }
}
