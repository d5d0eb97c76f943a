//! Construction of the journal law with inertia.

use super::JournalFull;
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::{check, Error};
use crate::law::journal::{Journal, Parameters};
use crate::real::Real;

impl<T: Real> JournalFull<T> {
    /// Creates a journal law with inertia for a bearing, a load (N) and parameters, on the time
    /// scale `clock`.
    ///
    /// # Errors
    /// Reports the first number that is not positive and finite.
    pub fn new(
        bearing: &Bearing,
        load_n: f64,
        parameters: &Parameters<T>,
        clock: Clock,
    ) -> Result<Self, Error> {
        let film = Journal::new(bearing, load_n, parameters, clock)?;
        let mass_number = bearing.mass_number(parameters.u_tr_m_s);
        let inverse_mass_number = T::ONE / mass_number;
        check(
            inverse_mass_number > T::ZERO && inverse_mass_number.is_finite(),
            "mass_number",
            mass_number.value(),
            "or its inverse overflows: check the units of the dimensions",
        )?;
        Ok(Self {
            film,
            inverse_mass_number,
        })
    }
}
