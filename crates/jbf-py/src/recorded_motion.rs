//! Python classes for the smoother of a recorded motion.

use jbf_motion::{
    estimate, log_likelihood, lower_bound, smooth, Known, LinearReading, Passes, ReadingErrors,
    Readings, Record, Smoothed,
};
use nalgebra::{SMatrix, Vector3};
use numpy::ndarray::{Array2, Array3};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Readings of a motion at n instants, with their relative standard errors.
#[pyclass(module = "jbf._core", frozen)]
pub struct MotionReadings {
    time: Vec<f64>,
    position: Vec<f64>,
    position_shape: Vec<f64>,
    position_floor: f64,
    velocity: Vec<f64>,
    velocity_shape: Vec<f64>,
    velocity_floor: f64,
    assigned: f64,
}

/// Error variances of the readings, from the attributes of
/// `jbf.records.motion.readings.ReadingErrors`.
#[derive(FromPyObject)]
pub struct Errors {
    position_variance: f64,
    velocity_variance: f64,
    stamp_variance: f64,
    intensity: f64,
    order: usize,
    velocity_delay_s: f64,
}

/// Estimated variances of position, velocity and time stamps, the intensity, and its factors.
type Estimated<'py> = (f64, f64, f64, f64, Bound<'py, PyArray1<f64>>);

/// Linear readings: coefficients, values and variances, and `jbf_motion::Record::continues`.
type Linear<'py> = (
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, bool>,
);

impl Errors {
    fn of_readings(&self) -> ReadingErrors {
        ReadingErrors {
            position_variance: self.position_variance,
            velocity_variance: self.velocity_variance,
            stamp_variance: self.stamp_variance,
            intensity: self.intensity,
            velocity_delay: self.velocity_delay_s,
        }
    }
}

/// Calls a function that is generic over the order of the motion (3 or 4).
macro_rules! of_order {
    ($order:expr, $function:ident, $($argument:expr),*) => {
        match $order {
            3 => Ok($function::<3>($($argument),*)),
            4 => Ok($function::<4>($($argument),*)),
            order => Err(PyValueError::new_err(format!("order must be 3 or 4 (got {order})"))),
        }
    };
}

impl MotionReadings {
    fn record(&self) -> Record<'_> {
        Record {
            time: &self.time,
            position: &self.position,
            position_shape: &self.position_shape,
            position_floor: self.position_floor,
            velocity: &self.velocity,
            velocity_shape: &self.velocity_shape,
            velocity_floor: self.velocity_floor,
            assigned: self.assigned,
            linear: &[],
            continues: &[],
        }
    }

    /// Converts linear readings and shared factors; there must be one for each instant and each
    /// step.
    fn linear(&self, read: &Linear<'_>) -> PyResult<(Vec<LinearReading>, Vec<bool>)> {
        let (rows, values) = (read.0.as_array(), read.1.as_array());
        let (variances, continues) = (read.2.as_array(), read.3.as_array());
        let n = self.time.len();
        let lengths = [values.len(), variances.len(), continues.len() + 1];
        if rows.dim() != (n, 3) || lengths != [n; 3] {
            let shapes = format!("rows {:?}, {} values", rows.dim(), values.len());
            return Err(PyValueError::new_err(format!("{shapes} for {n} instants")));
        }
        let reading = |k: usize| LinearReading {
            row: Vector3::from_fn(|i, _| rows[[k, i]]),
            value: values[k],
            variance: variances[k],
        };
        Ok(((0..n).map(reading).collect(), continues.to_vec()))
    }

    /// Converts the arrays to vectors; they must have n - 1 and n values.
    fn steps_and_samples(
        &self,
        corners: &PyReadonlyArray1<'_, f64>,
        speed: &PyReadonlyArray1<'_, f64>,
    ) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let (corners, speed) = (corners.as_array().to_vec(), speed.as_array().to_vec());
        let n = self.time.len();
        if corners.len() != n.saturating_sub(1) || speed.len() != n {
            let lengths = format!("{} factors and {} speeds", corners.len(), speed.len());
            return Err(PyValueError::new_err(format!("{lengths} for {n} instants")));
        }
        Ok((corners, speed))
    }
}

#[pymethods]
impl MotionReadings {
    /// Creates the readings of a motion from arrays of n values; see `jbf_motion::Record`.
    ///
    /// # Errors
    /// If the lengths differ.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        time: PyReadonlyArray1<'_, f64>,
        position: PyReadonlyArray1<'_, f64>,
        position_shape: PyReadonlyArray1<'_, f64>,
        position_floor: f64,
        velocity: PyReadonlyArray1<'_, f64>,
        velocity_shape: PyReadonlyArray1<'_, f64>,
        velocity_floor: f64,
        assigned: f64,
    ) -> PyResult<Self> {
        let copied = |array: &PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
        let read = Self {
            time: copied(&time),
            position: copied(&position),
            position_shape: copied(&position_shape),
            position_floor,
            velocity: copied(&velocity),
            velocity_shape: copied(&velocity_shape),
            velocity_floor,
            assigned,
        };
        let others = [
            &read.position,
            &read.position_shape,
            &read.velocity,
            &read.velocity_shape,
        ];
        if others.iter().any(|array| array.len() != read.time.len()) {
            return Err(PyValueError::new_err(format!(
                "arrays of lengths {:?} for {} instants",
                others.map(Vec::len),
                read.time.len()
            )));
        }
        Ok(read)
    }

    /// Computes the log-likelihood of the readings; see `jbf_motion::log_likelihood`.
    ///
    /// # Errors
    /// If the arrays have other lengths, or the order is neither 3 nor 4.
    fn log_likelihood(
        &self,
        py: Python<'_>,
        errors: Errors,
        corners: PyReadonlyArray1<'_, f64>,
        speed: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<f64> {
        let (corners, speed) = self.steps_and_samples(&corners, &speed)?;
        let (of_readings, record) = (errors.of_readings(), self.record());
        py.detach(|| {
            record.with(&of_readings, &corners, &speed, |readings, intensity| {
                of_order!(errors.order, log_likelihood, readings, intensity)
            })
        })
    }

    /// Computes a lower bound of the log-likelihood, marginal over the factors; see
    /// `jbf_motion::lower_bound`.
    ///
    /// # Errors
    /// As for `log_likelihood`.
    fn lower_bound(
        &self,
        py: Python<'_>,
        errors: Errors,
        corners: PyReadonlyArray1<'_, f64>,
        speed: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<f64> {
        let (corners, speed) = self.steps_and_samples(&corners, &speed)?;
        let (of_readings, record) = (errors.of_readings(), self.record());
        py.detach(|| {
            of_order!(
                errors.order,
                lower_bound,
                &record,
                &of_readings,
                &corners,
                &speed
            )
        })
    }

    /// Computes the posterior distribution of the motion; see `jbf_motion::smooth`.
    ///
    /// # Errors
    /// As for `log_likelihood`.
    fn smoothed(
        &self,
        py: Python<'_>,
        errors: Errors,
        corners: PyReadonlyArray1<'_, f64>,
        speed: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<SmoothedMotion> {
        fn smoothed<const N: usize>(
            py: Python<'_>,
            readings: &Readings,
            intensity: &[f64],
        ) -> SmoothedMotion {
            SmoothedMotion::new(py, py.detach(|| smooth::<N>(readings, intensity)))
        }
        let (corners, speed) = self.steps_and_samples(&corners, &speed)?;
        let using = |readings: &Readings, intensity: &[f64]| {
            of_order!(errors.order, smoothed, py, readings, intensity)
        };
        self.record()
            .with(&errors.of_readings(), &corners, &speed, using)
    }

    /// Estimates the error variances of the readings, the intensity and its factors from start
    /// values; see `jbf_motion::estimate`.
    ///
    /// `known` is "nothing", "intensity" or "everything"; see `jbf_motion::Known`. `linear` are
    /// measured linear functions of the motion, given by their coefficients of position, velocity
    /// and acceleration, (n, 3), values and variances. Returns the variances of position, velocity
    /// and time stamps, the intensity and the factors.
    ///
    /// # Errors
    /// As for `log_likelihood`.
    #[pyo3(signature = (errors, corners, passes, known, linear=None))]
    fn estimated<'py>(
        &self,
        py: Python<'py>,
        errors: Errors,
        corners: PyReadonlyArray1<'_, f64>,
        passes: (usize, usize),
        known: &str,
        linear: Option<Linear<'_>>,
    ) -> PyResult<Estimated<'py>> {
        let corners = corners.as_array().to_vec();
        if corners.len() != self.time.len().saturating_sub(1) {
            let lengths = format!("{} factors for {} instants", corners.len(), self.time.len());
            return Err(PyValueError::new_err(lengths));
        }
        let linear = linear.map_or(Ok(Default::default()), |read| self.linear(&read))?;
        let (start, mut record) = (errors.of_readings(), self.record());
        (record.linear, record.continues) = (&linear.0, &linear.1);
        let known = match known {
            "nothing" => Known::Nothing,
            "intensity" => Known::Intensity,
            "everything" => Known::Everything,
            other => {
                let problem = format!("known must be nothing, intensity or everything ({other})");
                return Err(PyValueError::new_err(problem));
            }
        };
        let passes = Passes {
            normal: passes.0,
            robust: passes.1,
        };
        let (found, corners) = py.detach(|| {
            of_order!(
                errors.order,
                estimate,
                &record,
                start,
                corners,
                passes,
                known
            )
        })?;
        Ok((
            found.position_variance,
            found.velocity_variance,
            found.stamp_variance,
            found.intensity,
            corners.into_pyarray(py),
        ))
    }
}

/// Posterior distribution of a motion of order N at n instants.
#[pyclass(module = "jbf._core", frozen, get_all)]
pub struct SmoothedMotion {
    /// Position and its first N - 1 derivatives at each instant, (n, N).
    mean: Py<PyArray2<f64>>,
    /// Covariance of the states at each instant, (n, N, N).
    covariance: Py<PyArray3<f64>>,
    /// Gains of the posterior as a Markov chain backward in time, (n - 1, N, N).
    gain: Py<PyArray3<f64>>,
}

impl SmoothedMotion {
    fn new<const N: usize>(py: Python<'_>, found: Smoothed<N>) -> Self {
        Self {
            mean: Array2::from_shape_fn((found.mean.len(), N), |(k, i)| found.mean[k][i])
                .into_pyarray(py)
                .unbind(),
            covariance: matrices(py, &found.covariance),
            gain: matrices(py, &found.gain),
        }
    }
}

fn matrices<const N: usize>(py: Python<'_>, all: &[SMatrix<f64, N, N>]) -> Py<PyArray3<f64>> {
    Array3::from_shape_fn((all.len(), N, N), |(k, i, j)| all[k][(i, j)])
        .into_pyarray(py)
        .unbind()
}
