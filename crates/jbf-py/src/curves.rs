//! Curves of the bare law: film integrals, transition eccentricity, Stribeck curve.

use jbf_core::film::FilmIntegrals;
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{transition, Bearing, Clock, ParameterError};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn refused(error: ParameterError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// J11, J12, J22 at an eccentricity ratio in [0, 1).
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

/// Transition eccentricity of a load number, equation (3.20).
#[pyfunction]
pub fn transition_eccentricity(load_number: f64) -> PyResult<f64> {
    if !(load_number > 0.0 && load_number.is_finite()) {
        return Err(PyValueError::new_err(format!(
            "load_number = {load_number} must be positive and finite"
        )));
    }
    Ok(transition::transition_eccentricity(load_number))
}

/// Steady eccentricity, attitude (rad) and friction coefficient at speeds (m/s, not zero).
#[pyfunction]
#[pyo3(signature = (velocity_m_s, *, f_m, u_tr_m_s, k0, gamma, radius_m, length_m, clearance_m,
                    mass_kg, count, viscosity_pa_s, load_n))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn steady_state<'py>(
    py: Python<'py>,
    velocity_m_s: PyReadonlyArray1<'py, f64>,
    f_m: f64,
    u_tr_m_s: f64,
    k0: f64,
    gamma: f64,
    radius_m: f64,
    length_m: f64,
    clearance_m: f64,
    mass_kg: f64,
    count: u32,
    viscosity_pa_s: f64,
    load_n: f64,
) -> PyResult<(
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
)> {
    let bearing = Bearing {
        radius_m,
        length_m,
        clearance_m,
        mass_kg,
        count,
        viscosity_pa_s,
    };
    let parameters = Parameters {
        f_m,
        u_tr_m_s,
        k0,
        gamma,
    };
    let law = Journal::new(&bearing, load_n, &parameters, Clock::Journal).map_err(refused)?;
    let (mut eps, mut phi, mut f) = (Vec::new(), Vec::new(), Vec::new());
    for &v in velocity_m_s.as_array() {
        let s = law.steady(v).map_err(refused)?;
        eps.push(s.eps);
        phi.push(s.phi_rad);
        f.push(s.coefficient);
    }
    Ok((
        eps.into_pyarray(py),
        phi.into_pyarray(py),
        f.into_pyarray(py),
    ))
}
