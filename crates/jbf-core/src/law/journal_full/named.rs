//! Description of the journal law with inertia in the catalogue.

use super::JournalFull;
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::Error;
use crate::law::journal::{parts, PARAMETERS};
use crate::law::{Info, Named, SteadyCurve};
use crate::real::Real;

impl<T: Real> Named<T> for JournalFull<T> {
    const INFO: Info = Info::new::<T, Self>("journal_full")
        .rust_type("JournalFull")
        .summary("hydrodynamic journal bearing with the inertia of the shaft (four states)")
        .equation("mb eps'' and mb eps phi'' of the film, (3.7) and (3.8); f as in journal")
        .source("Harnoy & Friedland 1994; Cohn 1998, equations (3.7), (3.8), (3.14)")
        .limits("short bearing, one load direction, constant viscosity")
        .parameters(PARAMETERS)
        .on_a_bearing()
        .with_a_film();

    fn build(
        bearing: Option<&Bearing>,
        load_n: Option<f64>,
        values: &[T],
        clock: Clock,
    ) -> Result<Self, Error> {
        let (bearing, load_n, parameters) = parts(bearing, load_n, values)?;
        JournalFull::new(bearing, load_n, &parameters, clock)
    }
}

impl SteadyCurve for JournalFull<f64> {
    /// Returns the steady friction of the law without inertia, because inertia has no influence on
    /// a steady state, N.
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        self.film.steady_n(velocity_m_s)
    }
}
