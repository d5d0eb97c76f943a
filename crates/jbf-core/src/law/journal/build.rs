//! Construction of the journal law: checks every number and precomputes constants.

use super::{Journal, Loaded, Parameters};
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::{check, not_negative, positive, Error};
use crate::real::Real;
use core::f64::consts::PI;

impl<T: Real> Journal<T> {
    /// Creates a journal law for a bearing, a load (N) and parameters, on the time scale `clock`.
    ///
    /// # Errors
    /// Reports the first number that is not positive and finite.
    pub fn new(
        bearing: &Bearing,
        load_n: f64,
        parameters: &Parameters<T>,
        clock: Clock,
    ) -> Result<Self, Error> {
        let bearing = bearing.checked()?;
        positive("load_n", load_n)?;
        let p = parameters;
        not_negative("f_m", p.f_m.value())?;
        positive("U_tr_m_s", p.u_tr_m_s.value())?;
        positive("K0", p.k0.value())?;
        not_negative("gamma", p.gamma.value())?;
        let fb_per_n = bearing.load_number(T::ONE, p.u_tr_m_s);
        let mut law = Self {
            fb_per_n,
            f_m: p.f_m,
            k0: p.k0,
            viscous_s_m: p.gamma * T::of(bearing.viscous_ratio() * 2.0 * PI) / p.u_tr_m_s,
            inverse_u_tr: T::ONE / p.u_tr_m_s,
            rate: match clock {
                Clock::Journal => p.u_tr_m_s * T::of(1.0 / bearing.radius_m),
                Clock::Thesis => T::ONE,
            },
            nominal: Loaded {
                load_n: T::ZERO,
                load_number: T::ZERO,
                inverse_load_number: T::ZERO,
                eps_tr: T::ZERO,
            },
            clock,
        };
        law.nominal = law.under(T::of(load_n));
        // Sizes in a wrong unit overflow here and would otherwise give infinite steps.
        let folded = [law.viscous_s_m, law.inverse_u_tr, law.rate]
            .iter()
            .all(|x| x.is_finite());
        let load_number = law.nominal.load_number;
        // The coefficients under the lightest load of the law are checked too.
        let per_load = law.under(T::ZERO).inverse_load_number;
        check(
            folded
                && load_number > T::ZERO
                && load_number.is_finite()
                && per_load.is_finite()
                && (law.viscous_s_m * per_load).is_finite(),
            "load_number",
            load_number.value(),
            "or another combination of the dimensions overflows: check their units",
        )?;
        Ok(law)
    }

    /// Sets the transition eccentricity instead of solving equation (3.20), to reproduce the tables
    /// of Cohn (1998).
    ///
    /// # Errors
    /// `eps_tr` must lie between 0 and 1.
    pub fn with_eps_tr(mut self, eps_tr: f64) -> Result<Self, Error> {
        check(
            eps_tr > 0.0 && eps_tr < 1.0,
            "eps_tr",
            eps_tr,
            "must lie between 0 and 1",
        )?;
        self.nominal.eps_tr = T::of(eps_tr);
        Ok(self)
    }
}
