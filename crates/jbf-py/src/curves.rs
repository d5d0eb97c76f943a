//! Curves of a law without effects: film integrals, transition eccentricity, Stribeck curve.

use crate::bearing::{refused, Sizes};
use jbf_core::internals::{self, FilmIntegrals};
use jbf_core::law::maxwell_slip::MaxwellSlip;
use jbf_core::law::Named;
use jbf_core::{law, Clock};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Film integrals J11, J12, J22 at an eccentricity ratio in [0, 1), equations (3.11) to (3.13) of
/// Cohn (1998).
#[pyfunction]
pub fn film_integrals(eps: f64) -> PyResult<(f64, f64, f64)> {
    if !(0.0..1.0).contains(&eps) {
        return Err(PyValueError::new_err(format!(
            "eps = {eps} must lie in [0, 1)"
        )));
    }
    let j = FilmIntegrals::at(eps);
    Ok((j.j11, j.j12, j.j22))
}

/// Transition eccentricity for a load number, equation (3.20) of Cohn (1998).
#[pyfunction]
pub fn transition_eccentricity(load_number: f64) -> PyResult<f64> {
    if !(load_number > 0.0 && load_number.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "load_number = {load_number} must be positive and finite"
        )));
    }
    Ok(internals::transition_eccentricity(load_number))
}

/// Steady friction of a law at speeds (m/s, not zero), N.
#[pyfunction]
#[pyo3(signature = (velocity_m_s, *, law, parameters, bearing, load_n))]
pub fn steady_friction<'py>(
    py: Python<'py>,
    velocity_m_s: PyReadonlyArray1<'py, f64>,
    law: &str,
    parameters: Vec<f64>,
    bearing: Option<Sizes>,
    load_n: Option<f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let bearing = bearing.map(Sizes::checked).transpose()?;
    let speeds: Vec<f64> = velocity_m_s.as_array().iter().copied().collect();
    let mut out = vec![0.0; speeds.len()];
    // The clock affects how fast a film moves, not its steady state.
    let clock = Clock::Journal;
    law::steady_n(
        law,
        bearing.as_ref(),
        load_n,
        &parameters,
        clock,
        &speeds,
        &mut out,
    )
    .map_err(refused)?;
    Ok(out.into_pyarray(py))
}

/// Stiffness (N/m) and friction level (N) of each element of the law `maxwell_slip`.
#[pyfunction]
pub fn maxwell_slip_elements(parameters: Vec<f64>) -> PyResult<Vec<(f64, f64)>> {
    let law = MaxwellSlip::build(None, None, &parameters, Clock::Journal).map_err(refused)?;
    Ok(law.elements().map(|[k, level]| (k, level)).to_vec())
}
