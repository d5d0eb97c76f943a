//! Python class for the parallel evaluation of many parameter sets of the journal law.

use crate::names;
use crate::pool::on_pool;
use jbf_batch::{Batch, Float, Method, Speeds};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Clock};
use numpy::{
    Element, IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn wrong(error: impl ToString) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Bearing, time scale and integration method of many parameter sets; a set is a row of `f_m,
/// U_tr_m_s, K0, gamma, load_n`.
#[pyclass(frozen, module = "jbf._core")]
pub struct BatchRig {
    bearing: Bearing,
    clock: Clock,
    method: Method,
}

#[pymethods]
impl BatchRig {
    #[new]
    #[pyo3(signature = (*, radius_m, length_m, clearance_m, mass_kg, count, viscosity_pa_s, clock,
                        method))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        radius_m: f64,
        length_m: f64,
        clearance_m: f64,
        mass_kg: f64,
        count: u32,
        viscosity_pa_s: f64,
        clock: &str,
        method: &str,
    ) -> PyResult<Self> {
        let bearing = Bearing::new()
            .with_radius_m(radius_m)
            .with_length_m(length_m)
            .with_clearance_m(clearance_m)
            .with_mass_kg(mass_kg)
            .with_count(count)
            .with_viscosity_pa_s(viscosity_pa_s);
        Ok(Self {
            bearing: bearing.checked().map_err(wrong)?,
            clock: names::clock(clock)?,
            method: match method {
                "euler" => Method::Euler,
                "rk4" => Method::Rk4,
                _ => {
                    return Err(wrong(format!(
                        "method {method:?} is not known: euler or rk4"
                    )))
                }
            },
        })
    }

    /// Computes friction coefficients into `out` in double precision, one row per sample and one
    /// column per set.
    fn friction_f64(
        &self,
        py: Python<'_>,
        sets: PyReadonlyArray2<'_, f64>,
        speeds: PyReadonlyArray1<'_, f64>,
        each: bool,
        dt_s: f64,
        out: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<()> {
        self.friction(py, &sets, &speeds, each, dt_s, out)
    }

    /// Computes friction coefficients into `out` in single precision, one row per sample and one
    /// column per set.
    fn friction_f32(
        &self,
        py: Python<'_>,
        sets: PyReadonlyArray2<'_, f64>,
        speeds: PyReadonlyArray1<'_, f32>,
        each: bool,
        dt_s: f64,
        out: PyReadwriteArray1<'_, f32>,
    ) -> PyResult<()> {
        self.friction(py, &sets, &speeds, each, dt_s, out)
    }

    /// Returns the sum of squared deviations of the friction coefficients from `data`, one per set,
    /// in double precision.
    fn squares_f64<'py>(
        &self,
        py: Python<'py>,
        sets: PyReadonlyArray2<'py, f64>,
        speeds: PyReadonlyArray1<'py, f64>,
        each: bool,
        dt_s: f64,
        data: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.squares(py, &sets, &speeds, each, dt_s, &data)
    }

    /// Returns the sum of squared deviations of the friction coefficients from `data`, one per set,
    /// in single precision.
    fn squares_f32<'py>(
        &self,
        py: Python<'py>,
        sets: PyReadonlyArray2<'py, f64>,
        speeds: PyReadonlyArray1<'py, f32>,
        each: bool,
        dt_s: f64,
        data: PyReadonlyArray1<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        self.squares(py, &sets, &speeds, each, dt_s, &data)
    }
}

impl BatchRig {
    fn batch<F: Float>(&self, sets: &PyReadonlyArray2<'_, f64>) -> PyResult<Batch<F>> {
        let table = sets.as_array();
        let laws = table.rows().into_iter().enumerate().map(|(i, row)| {
            let parameters = Parameters {
                f_m: F::of(row[0]),
                u_tr_m_s: F::of(row[1]),
                k0: F::of(row[2]),
                gamma: F::of(row[3]),
            };
            Journal::new(&self.bearing, row[4], &parameters, self.clock)
                .map_err(|e| wrong(format!("set {i}: {e}")))
        });
        Ok(Batch::new(laws.collect::<PyResult<_>>()?, self.method))
    }

    fn friction<F: Float + Element>(
        &self,
        py: Python<'_>,
        sets: &PyReadonlyArray2<'_, f64>,
        speeds: &PyReadonlyArray1<'_, F>,
        each: bool,
        dt_s: f64,
        mut out: PyReadwriteArray1<'_, F>,
    ) -> PyResult<()> {
        let batch = self.batch(sets)?;
        let speeds = course(speeds.as_slice()?, each, sets.as_array().nrows());
        let out = out.as_slice_mut()?;
        if out.len() != speeds.len() * sets.as_array().nrows() {
            return Err(wrong("out must have samples x sets elements"));
        }
        py.detach(|| on_pool(|| batch.friction(&mut batch.start(), &speeds, F::of(dt_s), out)));
        Ok(())
    }

    fn squares<'py, F: Float + Element>(
        &self,
        py: Python<'py>,
        sets: &PyReadonlyArray2<'py, f64>,
        speeds: &PyReadonlyArray1<'py, F>,
        each: bool,
        dt_s: f64,
        data: &PyReadonlyArray1<'py, F>,
    ) -> PyResult<Bound<'py, PyArray1<F>>> {
        let batch = self.batch(sets)?;
        let speeds = course(speeds.as_slice()?, each, sets.as_array().nrows());
        let data = data.as_slice()?;
        if data.len() != speeds.len() {
            return Err(wrong("data and motion must have equal length"));
        }
        let sums =
            py.detach(|| on_pool(|| batch.squares(&mut batch.start(), &speeds, F::of(dt_s), data)));
        Ok(sums.into_pyarray(py))
    }
}

fn course<F>(speeds: &[F], each: bool, sets: usize) -> Speeds<'_, F> {
    if each {
        Speeds::Each { rows: speeds, sets }
    } else {
        Speeds::Common(speeds)
    }
}
