//! Response of the instrument effects to a force, and its derivatives with respect to their
//! parameters.

use crate::bearing::refused;
use jbf_core::effect::Effects;
use jbf_core::{internals, Dual, Error};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Number of parameters per pass; an instrument has few parameters.
const LANES: usize = 4;

/// Computes the reading (N) of an instrument, and its derivatives with respect to the parameters.
///
/// The force (N) is sampled at times (s), and is linear between the samples. `effects` contains the
/// name and the parameter values of each effect. The derivatives have shape (n, parameters).
#[pyfunction]
#[allow(clippy::type_complexity)]
pub fn read_force<'py>(
    py: Python<'py>,
    effects: Vec<(String, Vec<f64>)>,
    time_s: PyReadonlyArray1<'py, f64>,
    force_n: PyReadonlyArray1<'py, f64>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)> {
    let slices = (time_s.as_slice(), force_n.as_slice());
    let (Ok(time_s), Ok(force_n)) = slices else {
        return Err(PyValueError::new_err("arrays must be contiguous"));
    };
    let n = time_s.len().min(force_n.len());
    let columns: usize = effects.iter().map(|(_, values)| values.len()).sum();
    let mut values = vec![0.0; n];
    let mut slopes = vec![0.0; n * columns];
    let mut read = || -> Result<(), Error> {
        for first in (0..columns.max(1)).step_by(LANES) {
            let chain = lifted(&effects, first)?;
            internals::read_force(&chain, time_s, force_n, |i, reading| {
                values[i] = reading.value;
                for (lane, &slope) in reading.slope.iter().enumerate() {
                    if first + lane < columns {
                        slopes[i * columns + first + lane] = slope;
                    }
                }
            });
        }
        Ok(())
    };
    read().map_err(refused)?;
    let shaped = numpy::ndarray::Array2::from_shape_vec((n, columns), slopes)
        .map_err(|e| PyValueError::new_err(e.to_string()))?;
    Ok((values.into_pyarray(py), shaped.into_pyarray(py)))
}

/// Creates the effects, with derivatives with respect to the `LANES` parameters from number `first`
/// on.
fn lifted(effects: &[(String, Vec<f64>)], first: usize) -> Result<Effects<Dual<LANES>>, Error> {
    let mut all = Effects::NONE;
    let mut number = 0;
    for (name, values) in effects {
        let own: Vec<Dual<LANES>> = values
            .iter()
            .enumerate()
            .map(|(k, &v)| Dual::parameter(v, (number + k).wrapping_sub(first)))
            .collect();
        number += values.len();
        all.set(name, &own)?;
    }
    Ok(all)
}
