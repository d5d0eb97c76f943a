//! The smoother of a recorded motion, and residuals whitened for its errors.

use jbf_motion::{Readings, Smoothed};
use numpy::ndarray::{Array2, Array3, ArrayView3};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The posterior of a motion at n instants.
#[pyclass(module = "jbf._core", frozen)]
pub struct SmoothedMotion {
    inner: Smoothed,
}

fn matrices<'py>(py: Python<'py>, rows: &[[[f64; 3]; 3]]) -> Bound<'py, PyArray3<f64>> {
    Array3::from_shape_fn((rows.len(), 3, 3), |(k, i, j)| rows[k][i][j]).into_pyarray(py)
}

/// The readings in these arrays.
fn readings<'a>(
    time: &'a PyReadonlyArray1<'_, f64>,
    position: &'a PyReadonlyArray1<'_, f64>,
    position_variance: &'a PyReadonlyArray1<'_, f64>,
    velocity: &'a PyReadonlyArray1<'_, f64>,
    velocity_variance: &'a PyReadonlyArray1<'_, f64>,
    jerk: &PyReadonlyArray1<'_, f64>,
    velocity_delay: f64,
) -> PyResult<Readings<'a>> {
    let readings = Readings {
        time: time.as_slice()?,
        position: position.as_slice()?,
        position_variance: position_variance.as_slice()?,
        velocity: velocity.as_slice()?,
        velocity_variance: velocity_variance.as_slice()?,
        velocity_delay,
    };
    let n = readings.time.len();
    let lengths = [
        readings.position.len(),
        readings.position_variance.len(),
        readings.velocity.len(),
        readings.velocity_variance.len(),
        jerk.as_slice()?.len() + 1,
    ];
    if lengths.iter().any(|length| *length != n) {
        return Err(PyValueError::new_err(format!(
            "arrays of lengths {lengths:?} for {n} instants"
        )));
    }
    Ok(readings)
}

/// Logarithm of the likelihood of the readings of a motion: see `jbf_motion::log_likelihood`.
///
/// # Errors
/// Arrays of other lengths.
#[pyfunction]
#[pyo3(signature = (time, position, position_variance, velocity, velocity_variance, jerk, velocity_delay=0.0))]
#[allow(clippy::too_many_arguments)]
pub fn motion_log_likelihood(
    py: Python<'_>,
    time: PyReadonlyArray1<'_, f64>,
    position: PyReadonlyArray1<'_, f64>,
    position_variance: PyReadonlyArray1<'_, f64>,
    velocity: PyReadonlyArray1<'_, f64>,
    velocity_variance: PyReadonlyArray1<'_, f64>,
    jerk: PyReadonlyArray1<'_, f64>,
    velocity_delay: f64,
) -> PyResult<f64> {
    let readings = readings(
        &time,
        &position,
        &position_variance,
        &velocity,
        &velocity_variance,
        &jerk,
        velocity_delay,
    )?;
    let jerk = jerk.as_slice()?;
    Ok(py.detach(|| jbf_motion::log_likelihood(&readings, jerk)))
}

#[pymethods]
impl SmoothedMotion {
    /// Smooth a motion: see `jbf_motion::smooth`. A variance of infinity marks a missing reading.
    #[new]
    #[pyo3(signature = (time, position, position_variance, velocity, velocity_variance, jerk, velocity_delay=0.0))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        time: PyReadonlyArray1<'_, f64>,
        position: PyReadonlyArray1<'_, f64>,
        position_variance: PyReadonlyArray1<'_, f64>,
        velocity: PyReadonlyArray1<'_, f64>,
        velocity_variance: PyReadonlyArray1<'_, f64>,
        jerk: PyReadonlyArray1<'_, f64>,
        velocity_delay: f64,
    ) -> PyResult<Self> {
        let readings = readings(
            &time,
            &position,
            &position_variance,
            &velocity,
            &velocity_variance,
            &jerk,
            velocity_delay,
        )?;
        let jerk = jerk.as_slice()?;
        let inner = py.detach(|| jbf_motion::smooth(&readings, jerk));
        Ok(Self { inner })
    }

    /// Position, velocity and acceleration at each instant, (n, 3).
    #[getter]
    fn mean<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        Array2::from(self.inner.mean.clone()).into_pyarray(py)
    }

    /// Their covariance at each instant, (n, 3, 3).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        matrices(py, &self.inner.covariance)
    }

    /// Gains of the posterior as a Markov chain backward in time, (n - 1, 3, 3).
    #[getter]
    fn gain<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray3<f64>> {
        matrices(py, &self.inner.gain)
    }

    /// Expected squared disturbance of each step, (n - 1,).
    #[getter]
    fn disturbance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.inner.disturbance.clone().into_pyarray(py)
    }

    /// Logarithm of the likelihood of the readings.
    #[getter]
    fn log_likelihood(&self) -> f64 {
        self.inner.log_likelihood
    }
}

/// Whiten columns of residuals that contain errors of the motion: see `jbf_motion::whiten`.
///
/// Returns the columns, (n, m), and the logarithm of the determinant of their covariance.
///
/// # Errors
/// Arrays of other shapes.
#[pyfunction]
pub fn whiten_motion_errors<'py>(
    py: Python<'py>,
    posterior: PyReadonlyArray3<'py, f64>,
    gain: PyReadonlyArray3<'py, f64>,
    sensitivity: PyReadonlyArray2<'py, f64>,
    variance: PyReadonlyArray1<'py, f64>,
    columns: PyReadonlyArray2<'py, f64>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, f64)> {
    let (p, g) = (posterior.as_array(), gain.as_array());
    let (s, c) = (sensitivity.as_array(), columns.as_array());
    let n = p.dim().0;
    let variance = variance.as_slice()?;
    let fits = p.dim() == (n, 3, 3)
        && g.dim() == (n.saturating_sub(1), 3, 3)
        && s.dim() == (n, 3)
        && variance.len() == n
        && c.nrows() == n;
    if !fits {
        return Err(PyValueError::new_err(format!(
            "posterior {:?}, gain {:?}, sensitivity {:?}, {} variances and columns {:?}",
            p.dim(),
            g.dim(),
            s.dim(),
            variance.len(),
            c.dim()
        )));
    }
    let square = |m: ArrayView3<'_, f64>| -> Vec<[[f64; 3]; 3]> {
        m.outer_iter()
            .map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[[i, j]])))
            .collect()
    };
    let (p, g) = (square(p), square(g));
    let rows: Vec<[f64; 3]> = s.rows().into_iter().map(|r| [r[0], r[1], r[2]]).collect();
    let width = c.ncols();
    let mut whitened = c.as_standard_layout().into_owned();
    let log_determinant = match whitened.as_slice_mut() {
        Some(flat) => py.detach(|| jbf_motion::whiten(&p, &g, &rows, variance, width, flat)),
        None => 0.0,
    };
    Ok((whitened.into_pyarray(py), log_determinant))
}
