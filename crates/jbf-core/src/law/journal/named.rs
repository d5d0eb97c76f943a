//! Description of the journal law in the catalogue.

use super::{Journal, Parameters, PARAMETERS, SUMMARY};
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::{exactly, needed, Error};
use crate::law::{Info, Named, SteadyCurve};
use crate::real::Real;

impl<T: Real> Named<T> for Journal<T> {
    const INFO: Info = Info::new::<T, Self>("journal")
        .rust_type("Journal")
        .summary(SUMMARY)
        .equation(
            "eps', phi' of the film; f = [f_m W sgn(U) + gamma (C R/L^2) 2 pi Ub / \
                   sqrt(1 - eps^2)] / Fb, W = K0 (eps - eps_tr)^2",
        )
        .source("Harnoy & Friedland 1994; Cohn 1998, chapter 3")
        .limits("short bearing, one load direction, constant viscosity, no inertia of the film")
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
        Journal::new(bearing, load_n, &parameters, clock)
    }
}

/// Checks the arguments of both journal laws; returns the bearing, the load (N) and the parameters.
pub(in crate::law) fn parts<'a, T: Real>(
    bearing: Option<&'a Bearing>,
    load_n: Option<f64>,
    values: &[T],
) -> Result<(&'a Bearing, f64, Parameters<T>), Error> {
    exactly("parameters", values.len(), PARAMETERS.len())?;
    let bearing = needed("bearing", bearing)?;
    let load_n = needed("load_n", load_n)?;
    let parameters = Parameters {
        f_m: values[0],
        u_tr_m_s: values[1],
        k0: values[2],
        gamma: values[3],
    };
    Ok((bearing, load_n, parameters))
}

impl SteadyCurve for Journal<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        Ok(self.steady(velocity_m_s)?.coefficient * self.nominal().load_n)
    }
}
