//! The smoother of a recorded motion, and residuals whitened for its errors.

use jbf_motion::{Readings, Smoothed};
use numpy::ndarray::{Array2, Array3, ArrayView2, ArrayView3};
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Readings of a motion at n instants with given error variances, and the noise that drives it.
#[pyclass(module = "jbf._core", frozen)]
pub struct MotionReadings {
    /// Instants, positions, their variances, velocities, their variances: n values each.
    columns: [Vec<f64>; 5],
    intensity: Vec<f64>,
    velocity_delay: f64,
    order: Order,
}

/// Which derivative of the position is white noise.
#[derive(Clone, Copy)]
enum Order {
    Jerk,
    Snap,
}

impl MotionReadings {
    fn readings(&self) -> Readings<'_> {
        let [time, position, position_variance, velocity, velocity_variance] = &self.columns;
        Readings {
            time,
            position,
            position_variance,
            velocity,
            velocity_variance,
            velocity_delay: self.velocity_delay,
        }
    }
}

#[pymethods]
impl MotionReadings {
    /// Readings from arrays of n values, and n - 1 intensities. A variance of infinity marks a
    /// missing reading.
    ///
    /// # Errors
    /// If the lengths differ, or the order is neither 3 nor 4.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        time: PyReadonlyArray1<'_, f64>,
        position: PyReadonlyArray1<'_, f64>,
        position_variance: PyReadonlyArray1<'_, f64>,
        velocity: PyReadonlyArray1<'_, f64>,
        velocity_variance: PyReadonlyArray1<'_, f64>,
        intensity: PyReadonlyArray1<'_, f64>,
        order: usize,
        velocity_delay: f64,
    ) -> PyResult<Self> {
        let order = match order {
            3 => Order::Jerk,
            4 => Order::Snap,
            _ => return Err(PyValueError::new_err(format!("order {order}, not 3 or 4"))),
        };
        let copied = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
        let read = Self {
            columns: [
                copied(&time),
                copied(&position),
                copied(&position_variance),
                copied(&velocity),
                copied(&velocity_variance),
            ],
            intensity: copied(&intensity),
            velocity_delay,
            order,
        };
        let n = read.columns[0].len();
        let others = read.columns.iter().any(|column| column.len() != n);
        if others || (n > 0 && read.intensity.len() + 1 != n) {
            return Err(PyValueError::new_err(format!(
                "arrays of lengths {:?} and {} steps for {n} instants",
                read.columns.each_ref().map(Vec::len),
                read.intensity.len()
            )));
        }
        Ok(read)
    }

    /// Logarithm of the likelihood of the readings: see `jbf_motion::log_likelihood`.
    fn log_likelihood(&self, py: Python<'_>) -> f64 {
        let readings = self.readings();
        py.detach(|| match self.order {
            Order::Jerk => jbf_motion::log_likelihood::<3>(&readings, &self.intensity),
            Order::Snap => jbf_motion::log_likelihood::<4>(&readings, &self.intensity),
        })
    }

    /// The posterior of the motion: see `jbf_motion::smooth`.
    fn smoothed<'py>(&self, py: Python<'py>) -> SmoothedMotion {
        let readings = self.readings();
        match self.order {
            Order::Jerk => {
                let found = py.detach(|| jbf_motion::smooth::<3>(&readings, &self.intensity));
                SmoothedMotion::new(py, found)
            }
            Order::Snap => {
                let found = py.detach(|| jbf_motion::smooth::<4>(&readings, &self.intensity));
                SmoothedMotion::new(py, found)
            }
        }
    }
}

/// The posterior of a motion of order N at n instants.
#[pyclass(module = "jbf._core", frozen, get_all)]
pub struct SmoothedMotion {
    /// Position and its first N - 1 derivatives at each instant, (n, N).
    mean: Py<PyArray2<f64>>,
    /// Their covariance at each instant, (n, N, N).
    covariance: Py<PyArray3<f64>>,
    /// Gains of the posterior as a Markov chain backward in time, (n - 1, N, N).
    gain: Py<PyArray3<f64>>,
    /// Expected squared disturbance of each step, (n - 1,).
    disturbance: Py<PyArray1<f64>>,
    /// Logarithm of the likelihood of the readings.
    log_likelihood: f64,
}

impl SmoothedMotion {
    fn new<const N: usize>(py: Python<'_>, found: Smoothed<N>) -> Self {
        Self {
            mean: Array2::from(found.mean).into_pyarray(py).unbind(),
            covariance: matrices(py, &found.covariance),
            gain: matrices(py, &found.gain),
            disturbance: found.disturbance.into_pyarray(py).unbind(),
            log_likelihood: found.log_likelihood,
        }
    }
}

fn matrices<const N: usize>(py: Python<'_>, rows: &[[[f64; N]; N]]) -> Py<PyArray3<f64>> {
    Array3::from_shape_fn((rows.len(), N, N), |(k, i, j)| rows[k][i][j])
        .into_pyarray(py)
        .unbind()
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
    let width = columns.as_array().ncols();
    let mut whitened = columns.as_array().as_standard_layout().into_owned();
    let chain = Chain {
        posterior: posterior.as_array(),
        gain: gain.as_array(),
        sensitivity: sensitivity.as_array(),
        variance: variance.as_slice()?,
    };
    let order = chain.posterior.dim().1;
    if !chain.fits(order) || whitened.nrows() != chain.variance.len() {
        return Err(PyValueError::new_err(format!(
            "posterior {:?}, gain {:?}, sensitivity {:?}, {} variances and columns {:?}",
            chain.posterior.dim(),
            chain.gain.dim(),
            chain.sensitivity.dim(),
            chain.variance.len(),
            whitened.dim()
        )));
    }
    let log_determinant = match (whitened.as_slice_mut(), order) {
        (Some(flat), 3) => chain.whiten::<3>(width, flat),
        (Some(flat), 4) => chain.whiten::<4>(width, flat),
        _ => return Err(PyValueError::new_err(format!("order {order}, not 3 or 4"))),
    };
    Ok((whitened.into_pyarray(py), log_determinant))
}

/// The errors of a motion and their effect on n residuals.
struct Chain<'a> {
    posterior: ArrayView3<'a, f64>,
    gain: ArrayView3<'a, f64>,
    sensitivity: ArrayView2<'a, f64>,
    variance: &'a [f64],
}

impl Chain<'_> {
    /// Whether the arrays have the shapes for a motion of an order.
    fn fits(&self, order: usize) -> bool {
        let n = self.variance.len();
        self.posterior.dim() == (n, order, order)
            && self.gain.dim() == (n.saturating_sub(1), order, order)
            && self.sensitivity.dim() == (n, 3)
    }

    fn whiten<const N: usize>(&self, width: usize, columns: &mut [f64]) -> f64 {
        let square = |m: &ArrayView3<'_, f64>| -> Vec<[[f64; N]; N]> {
            m.outer_iter()
                .map(|m| std::array::from_fn(|i| std::array::from_fn(|j| m[[i, j]])))
                .collect()
        };
        let rows = self.sensitivity.rows().into_iter();
        let sensitivity: Vec<[f64; 3]> = rows.map(|r| [r[0], r[1], r[2]]).collect();
        let (posterior, gain) = (square(&self.posterior), square(&self.gain));
        jbf_motion::whiten(
            &posterior,
            &gain,
            &sensitivity,
            self.variance,
            width,
            columns,
        )
    }
}
