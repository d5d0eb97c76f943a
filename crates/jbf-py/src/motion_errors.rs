//! Whitening of residuals that contain the errors of a recorded motion.

use crate::pool::on_pool;
use crate::share::longest_first;
use jbf_motion::{ErrorChain, WhiteningFilter};
use nalgebra::{SMatrix, Vector3};
use numpy::ndarray::{ArrayView1, ArrayView2, ArrayView3};
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

/// Filter of the residuals of one run; without errors of the motion, they are multiplied by the
/// weights.
enum Filter {
    Weights(Vec<f64>),
    Three(WhiteningFilter<3>),
    Four(WhiteningFilter<4>),
}

impl Filter {
    fn log_determinant(&self) -> f64 {
        match self {
            Self::Weights(weight) => {
                let used = weight.iter().filter(|w| **w > 0.0);
                -2.0 * used.map(|w| w.ln()).sum::<f64>()
            }
            Self::Three(filter) => filter.log_determinant,
            Self::Four(filter) => filter.log_determinant,
        }
    }

    fn whiten(&self, width: usize, columns: &mut [f64]) {
        match self {
            Self::Weights(weight) => {
                for (row, w) in columns.chunks_exact_mut(width.max(1)).zip(weight) {
                    row.iter_mut().for_each(|value| *value *= w);
                }
            }
            Self::Three(filter) => filter.whiten(width, columns),
            Self::Four(filter) => filter.whiten(width, columns),
        }
    }
}

/// Filter that whitens residuals with errors of the motion, for a set of runs; see
/// `jbf_motion::ErrorChain::filter`.
#[pyclass(module = "jbf._core", frozen)]
pub struct MotionWhitening {
    filters: Vec<Filter>,
    lengths: Vec<usize>,
    /// Logarithm of the determinant of the covariance of all included samples.
    #[pyo3(get)]
    log_determinant: f64,
}

/// Run for which a filter is created.
struct Posed<'a> {
    errors: Option<&'a Errors>,
    sensitivity: Vec<Vector3<f64>>,
    weight: Vec<f64>,
}

impl Posed<'_> {
    fn filter(&self) -> Filter {
        let (s, w) = (&self.sensitivity, &self.weight);
        match self.errors {
            None => Filter::Weights(w.clone()),
            Some(Errors::Three(chain)) => Filter::Three(chain.filter(s, w)),
            Some(Errors::Four(chain)) => Filter::Four(chain.filter(s, w)),
        }
    }
}

#[pymethods]
impl MotionWhitening {
    /// Creates the filters of a set of runs.
    ///
    /// # Arguments
    /// * `chains`: errors of the motion of each run; `None` where they are not known.
    /// * `sensitivity`: derivatives of the residual with respect to position, velocity and
    ///   acceleration, (n, 3) for each run, times `ratio` in standard deviations of the noise.
    /// * `weight`: weight of each sample, (n,) for each run; a sample of weight zero is excluded.
    #[new]
    fn new<'py>(
        py: Python<'py>,
        chains: Vec<Option<Py<MotionErrorChain>>>,
        sensitivity: Vec<PyReadonlyArray2<'py, f64>>,
        ratio: f64,
        weight: Vec<PyReadonlyArray1<'py, f64>>,
    ) -> PyResult<Self> {
        let arrays = sensitivity.iter().zip(&weight);
        let posed: Vec<Posed<'_>> = chains
            .iter()
            .zip(arrays)
            .map(|(chain, (s, w))| {
                let (s, w) = (s.as_array(), w.as_array());
                let errors = chain.as_ref().map(|chain| &chain.get().0);
                let instants = chain.as_ref().map_or(w.len(), |chain| chain.get().len());
                if s.dim() != (w.len(), 3) || instants != w.len() {
                    return Err(PyValueError::new_err(format!(
                        "{instants} instants, sensitivity {:?} and {} weights",
                        s.dim(),
                        w.len()
                    )));
                }
                let row = |r: ArrayView1<'_, f64>| Vector3::new(r[0], r[1], r[2]) * ratio;
                Ok(Posed {
                    errors,
                    sensitivity: s.rows().into_iter().map(row).collect(),
                    weight: w.to_vec(),
                })
            })
            .collect::<PyResult<_>>()?;
        let size = |run: &Posed<'_>| run.weight.len();
        let create = |run: &Posed<'_>| PyResult::Ok(run.filter());
        let filters = py.detach(|| on_pool(|| longest_first(&posed, size, create)))?;
        Ok(Self {
            log_determinant: filters.iter().map(Filter::log_determinant).sum(),
            lengths: posed.iter().map(size).collect(),
            filters,
        })
    }

    /// Returns the whitened columns, (n, m), of some of the runs; excluded samples are zero.
    ///
    /// # Errors
    /// If a run or a shape differs from those of the filters.
    fn whiten<'py>(
        &self,
        py: Python<'py>,
        columns: Vec<PyReadonlyArray2<'py, f64>>,
        runs: Vec<usize>,
    ) -> PyResult<Vec<Bound<'py, PyArray2<f64>>>> {
        let arrays: Vec<(&Filter, ArrayView2<'_, f64>)> = runs
            .iter()
            .zip(&columns)
            .map(|(&run, c)| match self.lengths.get(run) {
                Some(&length) if length == c.as_array().nrows() => {
                    Ok((&self.filters[run], c.as_array()))
                }
                length => Err(PyValueError::new_err(format!(
                    "run {run} of {length:?} samples, columns {:?}",
                    c.as_array().dim()
                ))),
            })
            .collect::<PyResult<_>>()?;
        let size = |(_, c): &(&Filter, ArrayView2<'_, f64>)| c.len();
        let whitened = |(filter, c): &(&Filter, ArrayView2<'_, f64>)| {
            let mut white = c.as_standard_layout().into_owned();
            if let Some(values) = white.as_slice_mut() {
                filter.whiten(c.ncols(), values);
            }
            PyResult::Ok(white)
        };
        let all = py.detach(|| on_pool(|| longest_first(&arrays, size, whitened)))?;
        Ok(all
            .into_iter()
            .map(|white| white.into_pyarray(py))
            .collect())
    }
}
