//! First-order filter along samples, to whiten or generate autocorrelated noise.

use numpy::ndarray::{ArrayD, Axis};
use numpy::{IntoPyArray, PyArrayDyn, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Computes `y(t) = now[0] x(t) + now[1] x(t - 1) - before y(t - 1)` along the first axis of values
/// of shape (n,) or (n, k); earlier values are zero.
///
/// # Errors
/// If the values have another shape.
#[pyfunction]
pub fn first_order_filter<'py>(
    py: Python<'py>,
    now: [f64; 2],
    before: f64,
    values: PyReadonlyArrayDyn<'py, f64>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let x = values.as_array();
    if x.ndim() == 0 || x.ndim() > 2 {
        return Err(PyValueError::new_err(format!(
            "values have {} axes: must be (n,) or (n, k)",
            x.ndim()
        )));
    }
    let width = if x.ndim() == 2 { x.len_of(Axis(1)) } else { 1 };
    let mut y: ArrayD<f64> = x.as_standard_layout().into_owned();
    if let Some(flat) = y.as_slice_mut() {
        py.detach(|| filter(now, before, width, flat));
    }
    Ok(y.into_pyarray(py))
}

/// Filters n rows of `width` values in place.
fn filter(now: [f64; 2], before: f64, width: usize, values: &mut [f64]) {
    let mut rest = vec![0.0; width];
    for row in values.chunks_exact_mut(width.max(1)) {
        for (value, rest) in row.iter_mut().zip(&mut rest) {
            let x = *value;
            let y = now[0] * x + *rest;
            *rest = now[1] * x - before * y;
            *value = y;
        }
    }
}
