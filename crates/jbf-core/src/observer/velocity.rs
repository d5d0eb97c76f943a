//! Velocity observer, equation (6.2) of Cohn (1998).
//!
//! The state is v_hat instead of z: `v_hat += k (x - x_before) + dt z'`. This is equivalent to the
//! Euler step in Cohn (1998), and neither the angle nor its rounding error grows over hours.

use crate::error::{check, not_negative, positive, Error};
use crate::real::Real;

/// Velocity observer, equation (6.2) of Cohn (1998), without or with feedforward of the input of the
/// plant; the state is the estimated speed `v_hat`, rad/s.
///
/// ```text
/// v_hat = z + k x,   z' = -k v_hat                    (without feedforward)
///                    z' = -(a + k) v_hat + b u        (with feedforward)
/// ```
///
/// At each sample, call [`correct`](Self::correct), the control law, and
/// [`predict`](Self::predict):
///
/// ```
/// use jbf_core::observer::VelocityObserver;
///
/// let dt_s = 1e-3;
/// let observer = VelocityObserver::new(100.0, dt_s)?;
/// let mut velocity_rad_s = 0.0;
/// for _ in 0..200 {
///     velocity_rad_s = observer.correct(velocity_rad_s, 2.0 * dt_s); // rotation since the last sample
///     // The control law computes the input u from `velocity_rad_s` here.
///     velocity_rad_s = observer.predict(velocity_rad_s, 0.0);
/// }
/// assert!((velocity_rad_s - 2.0_f64).abs() < 0.3);
/// # Ok::<(), jbf_core::Error>(())
/// ```
///
/// Source: Tafazoli, de Silva & Lawrence (1995); Cohn (1998), (6.2), Appendices D and E.
#[derive(Clone, Copy, Debug)]
pub struct VelocityObserver<T> {
    gain_1_s: T,
    keep: T,
    input: T,
}

impl<T: Real> VelocityObserver<T> {
    /// Creates the observer without feedforward, with the gain `k` (1/s).
    ///
    /// # Errors
    /// The gain must be positive, and `k dt` below 1.
    pub fn new(gain_1_s: f64, dt_s: f64) -> Result<Self, Error> {
        Self::with_feedforward(gain_1_s, 0.0, 0.0, dt_s)
    }

    /// Creates the observer with feedforward of the input of the plant, `v' = -a v + b u`.
    ///
    /// # Errors
    /// Gains must be positive (`a` and `b` may be zero), and `(a + k) dt` below 1.
    pub fn with_feedforward(
        gain_1_s: f64,
        damping_1_s: f64,
        input_rad_s2_v: f64,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("gain_1_s", gain_1_s)?;
        positive("dt_s", dt_s)?;
        for (name, value) in [
            ("damping_1_s", damping_1_s),
            ("input_rad_s2_v", input_rad_s2_v),
        ] {
            not_negative(name, value)?;
        }
        let decay = (gain_1_s + damping_1_s) * dt_s;
        check(
            decay < 1.0,
            "gain_1_s",
            gain_1_s,
            "is too large for the time step: (a + k) dt must stay below 1",
        )?;
        Ok(Self {
            gain_1_s: T::of(gain_1_s),
            keep: T::of(1.0 - decay),
            input: T::of(input_rad_s2_v * dt_s),
        })
    }

    /// Returns the estimated speed, rad/s, corrected after the shaft has moved by `moved_rad`.
    ///
    /// It is called before the control law.
    #[inline]
    #[must_use]
    pub fn correct(&self, velocity_rad_s: T, moved_rad: T) -> T {
        velocity_rad_s + self.gain_1_s * moved_rad
    }

    /// Returns the speed predicted for the next sample, rad/s, under the input `u_v` (V; ignored
    /// without feedforward).
    ///
    /// It is called after the control law.
    #[inline]
    #[must_use]
    pub fn predict(&self, velocity_rad_s: T, u_v: T) -> T {
        self.keep * velocity_rad_s + self.input * u_v
    }
}
