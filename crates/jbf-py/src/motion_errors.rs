//! Whitening of residuals that contain the errors of a recorded motion.

use crate::pool::on_pool;
use crate::share::longest_first;
use jbf_motion::ErrorChain;
use nalgebra::{SMatrix, Vector3};
use numpy::ndarray::{Array2, ArrayView3};
use numpy::{IntoPyArray, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Chain of the errors of a motion of order 3 or 4.
enum Errors {
    Three(ErrorChain<3>),
    Four(ErrorChain<4>),
}

/// Errors of the motion of a run, prepared for the whitening of residuals that contain them.
#[pyclass(module = "jbf._core", frozen)]
pub struct MotionErrorChain(Errors);

#[pymethods]
impl MotionErrorChain {
    /// Creates the chain from posterior covariances (n, N, N) and gains (n - 1, N, N); N is 3 or 4.
    #[new]
    fn new(
        posterior: PyReadonlyArray3<'_, f64>,
        gain: PyReadonlyArray3<'_, f64>,
    ) -> PyResult<Self> {
        let (posterior, gain) = (posterior.as_array(), gain.as_array());
        let (n, order, _) = posterior.dim();
        let fits = posterior.dim() == (n, order, order)
            && gain.dim() == (n.saturating_sub(1), order, order);
        match order {
            3 if fits => Ok(Self(Errors::Three(chain_of(&posterior, &gain)))),
            4 if fits => Ok(Self(Errors::Four(chain_of(&posterior, &gain)))),
            _ => Err(PyValueError::new_err(format!(
                "posterior {:?} and gain {:?} are not those of a motion of order 3 or 4",
                posterior.dim(),
                gain.dim()
            ))),
        }
    }
}

impl MotionErrorChain {
    fn len(&self) -> usize {
        match &self.0 {
            Errors::Three(chain) => chain.len(),
            Errors::Four(chain) => chain.len(),
        }
    }
}

fn chain_of<const N: usize>(
    posterior: &ArrayView3<'_, f64>,
    gain: &ArrayView3<'_, f64>,
) -> ErrorChain<N> {
    let square = |all: &ArrayView3<'_, f64>| -> Vec<SMatrix<f64, N, N>> {
        all.outer_iter()
            .map(|m| SMatrix::from_fn(|i, j| m[[i, j]]))
            .collect()
    };
    ErrorChain::new(&square(posterior), &square(gain))
}

/// Residuals of one run that contain errors of its motion.
struct Residuals<'a> {
    chain: &'a Errors,
    sensitivity: Vec<Vector3<f64>>,
    variance: Vec<f64>,
    columns: Array2<f64>,
}

impl Residuals<'_> {
    /// Returns the whitened columns and the logarithm of the determinant of their covariance.
    fn whitened(&self) -> PyResult<(Array2<f64>, f64)> {
        let (rows, width) = self.columns.dim();
        let mut flat: Vec<f64> = self.columns.iter().copied().collect();
        let (s, v) = (&self.sensitivity, &self.variance);
        let log_determinant = match self.chain {
            Errors::Three(chain) => chain.whiten(s, v, width, &mut flat),
            Errors::Four(chain) => chain.whiten(s, v, width, &mut flat),
        };
        let white = Array2::from_shape_vec((rows, width), flat)
            .map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok((white, log_determinant))
    }
}

/// Whitens columns of residuals that contain errors of a motion, for each of several runs; see
/// `jbf_motion::ErrorChain::whiten`.
///
/// Returns, for each run, the columns, (n, m), and the logarithm of the determinant of their
/// covariance.
///
/// # Errors
/// If the arrays have other shapes.
#[pyfunction]
pub fn whiten_motion_errors<'py>(
    py: Python<'py>,
    chains: Vec<Py<MotionErrorChain>>,
    sensitivity: Vec<PyReadonlyArray2<'py, f64>>,
    variance: Vec<PyReadonlyArray1<'py, f64>>,
    columns: Vec<PyReadonlyArray2<'py, f64>>,
) -> PyResult<Vec<(Bound<'py, PyArray2<f64>>, f64)>> {
    let arrays = sensitivity.iter().zip(&variance).zip(&columns);
    let runs: Vec<Residuals<'_>> = chains
        .iter()
        .zip(arrays)
        .map(|(chain, ((s, v), c))| {
            let (s, v, c) = (s.as_array(), v.as_array(), c.as_array());
            let (chain, n) = (chain.get(), v.len());
            if s.dim() != (n, 3) || c.nrows() != n || chain.len() != n {
                return Err(PyValueError::new_err(format!(
                    "{} instants, sensitivity {:?}, {n} variances and columns {:?}",
                    chain.len(),
                    s.dim(),
                    c.dim()
                )));
            }
            let rows = s.rows().into_iter();
            Ok(Residuals {
                chain: &chain.0,
                sensitivity: rows.map(|r| Vector3::new(r[0], r[1], r[2])).collect(),
                variance: v.to_vec(),
                columns: c.to_owned(),
            })
        })
        .collect::<PyResult<_>>()?;
    let size = |run: &Residuals<'_>| run.columns.len();
    let whitened = py.detach(|| on_pool(|| longest_first(&runs, size, Residuals::whitened)))?;
    Ok(whitened
        .into_iter()
        .map(|(columns, log_determinant)| (columns.into_pyarray(py), log_determinant))
        .collect())
}
