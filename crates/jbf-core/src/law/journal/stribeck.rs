//! Stribeck curve of the journal law: its steady states, (3.5) and (3.6) of Cohn (1998).

use super::Journal;
use crate::error::{check, Error};
use crate::law::{steady, Steady};
use crate::real::Real;

impl Journal<f64> {
    /// Returns the steady eccentricity ratio, attitude angle and friction coefficient at a speed
    /// (m/s, signed).
    ///
    /// # Errors
    /// The speed must be finite and not zero: at rest the friction is set-valued.
    pub fn steady(&self, velocity_m_s: f64) -> Result<Steady, Error> {
        check(
            velocity_m_s.is_finite() && velocity_m_s != 0.0,
            "velocity_m_s",
            velocity_m_s,
            "must be finite and not zero",
        )?;
        let ub = libm::fabs(velocity_m_s) * self.inverse_u_tr;
        let loaded = &self.nominal;
        let (eps, phi_rad) = steady::solve(loaded.load_number, ub, |eps| {
            self.asperity_load(eps, loaded.eps_tr)
        });
        let coefficient = self
            .sliding(loaded, eps * eps, velocity_m_s)
            .along(velocity_m_s.sign());
        Ok(Steady {
            eps,
            phi_rad,
            coefficient,
        })
    }
}
