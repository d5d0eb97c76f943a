//! A law with effects, over whole runs: prediction and its derivatives.

use crate::motion::Motion;
use jbf_core::effect::{Effects, Info, Rig, CATALOGUE};
use jbf_core::law::journal::{self, Journal, Parameters};
use jbf_core::{run, Bearing, Clock, Dual, ParameterError, Real};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Derivatives carried side by side in one pass.
const LANES: usize = 4;

/// A friction law and effects round it; parameters come with each call.
#[pyclass(frozen, module = "jbf._core")]
pub struct Chain {
    bearing: Bearing,
    load_n: f64,
    clock: Clock,
    effects: Vec<&'static Info>,
    max_step_s: f64,
}

fn refused(error: ParameterError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

impl Chain {
    fn count(&self) -> usize {
        journal::PARAMETERS.len()
            + self
                .effects
                .iter()
                .map(|e| e.parameters.len())
                .sum::<usize>()
    }

    /// The core's chain for one set of parameter values.
    fn build<T: Real>(&self, p: &[T]) -> Result<jbf_core::Chain<T, Journal<T>>, ParameterError> {
        let parameters = Parameters {
            f_m: p[0],
            u_tr_m_s: p[1],
            k0: p[2],
            gamma: p[3],
        };
        let law = Journal::new(&self.bearing, self.load_n, &parameters, self.clock)?;
        let mut effects = Effects::NONE;
        let mut at = journal::PARAMETERS.len();
        for info in &self.effects {
            let end = at + info.parameters.len();
            effects.set(info.name, &p[at..end])?;
            at = end;
        }
        let rig = Rig {
            radius_m: T::of(self.bearing.radius_m),
            count: T::of(f64::from(self.bearing.count)),
        };
        Ok(jbf_core::Chain { law, effects, rig })
    }

    fn checked<'a>(&self, parameters: &'a PyReadonlyArray1<'_, f64>) -> PyResult<&'a [f64]> {
        let p = parameters
            .as_slice()
            .map_err(|_| PyValueError::new_err("parameters must be a contiguous array"))?;
        if p.len() == self.count() {
            Ok(p)
        } else {
            Err(PyValueError::new_err(format!(
                "{} parameters given, {} needed",
                p.len(),
                self.count()
            )))
        }
    }

    /// Value and `LANES` derivatives, those of the parameters `which`, along one run.
    fn slopes(
        &self,
        p: &[f64],
        which: &[usize],
        motion: &Motion,
    ) -> Result<(Vec<f64>, Vec<[f64; LANES]>), ParameterError> {
        let lifted: Vec<Dual<LANES>> = p
            .iter()
            .enumerate()
            .map(|(i, &v)| match which.iter().position(|&w| w == i) {
                Some(lane) => Dual::parameter(v, lane),
                None => Dual::of(v),
            })
            .collect();
        let chain = self.build(&lifted)?;
        let mut values = vec![0.0; motion.len()];
        let mut slopes = vec![[0.0; LANES]; motion.len()];
        run::predict(&chain, &motion.record(), self.max_step_s, |i, f| {
            values[i] = f.value;
            slopes[i] = f.slope;
        });
        Ok((values, slopes))
    }
}

#[pymethods]
impl Chain {
    #[new]
    #[pyo3(signature = (*, radius_m, length_m, clearance_m, mass_kg, count, viscosity_pa_s,
                        load_n, clock, effects, max_step_s))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        radius_m: f64,
        length_m: f64,
        clearance_m: f64,
        mass_kg: f64,
        count: u32,
        viscosity_pa_s: f64,
        load_n: f64,
        clock: &str,
        effects: Vec<String>,
        max_step_s: f64,
    ) -> PyResult<Self> {
        let bearing = Bearing {
            radius_m,
            length_m,
            clearance_m,
            mass_kg,
            count,
            viscosity_pa_s,
        };
        let clock = Clock::from_name(clock).ok_or_else(|| {
            PyValueError::new_err(format!("clock {clock:?} is neither journal nor thesis"))
        })?;
        if !(max_step_s > 0.0 && max_step_s.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "max_step_s = {max_step_s} must be positive and finite"
            )));
        }
        let effects = effects
            .iter()
            .map(|name| {
                CATALOGUE
                    .iter()
                    .find(|info| info.name == name)
                    .ok_or_else(|| {
                        PyValueError::new_err(format!("effect {name:?} is not in the catalogue"))
                    })
            })
            .collect::<PyResult<Vec<_>>>()?;
        Ok(Self {
            bearing: bearing.checked().map_err(refused)?,
            load_n,
            clock,
            effects,
            max_step_s,
        })
    }

    /// Dotted names of the parameters, in the order of every array here.
    #[getter]
    fn parameter_names(&self) -> Vec<String> {
        let own = journal::PARAMETERS.iter().map(|p| p.name.to_string());
        let theirs = self.effects.iter().flat_map(|e| {
            e.parameters
                .iter()
                .map(|p| format!("{}.{}", e.name, p.name))
        });
        own.chain(theirs).collect()
    }

    /// Friction readings, N, one array a run.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        parameters: PyReadonlyArray1<'py, f64>,
        motions: Vec<Py<Motion>>,
    ) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let p = self.checked(&parameters)?;
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let runs = py
            .detach(|| {
                let chain = self.build::<f64>(p)?;
                Ok(motions
                    .par_iter()
                    .map(|motion| {
                        let mut values = vec![0.0; motion.len()];
                        run::predict(&chain, &motion.record(), self.max_step_s, |i, f| {
                            values[i] = f;
                        });
                        values
                    })
                    .collect::<Vec<_>>())
            })
            .map_err(refused)?;
        Ok(runs.into_iter().map(|v| v.into_pyarray(py)).collect())
    }

    /// Readings (N) and their derivatives with respect to the parameters `which`: for each
    /// run an array of n values and one of shape (n, len(which)).
    #[allow(clippy::type_complexity)]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        parameters: PyReadonlyArray1<'py, f64>,
        motions: Vec<Py<Motion>>,
        which: Vec<usize>,
    ) -> PyResult<Vec<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>)>> {
        let p = self.checked(&parameters)?;
        if let Some(bad) = which.iter().find(|&&w| w >= p.len()) {
            return Err(PyValueError::new_err(format!(
                "there is no parameter number {bad}"
            )));
        }
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let columns = which.len();
        let runs = py
            .detach(|| {
                let groups: Vec<&[usize]> = if columns == 0 {
                    vec![&[]]
                } else {
                    which.chunks(LANES).collect()
                };
                let jobs: Vec<(usize, usize)> = (0..motions.len())
                    .flat_map(|m| (0..groups.len()).map(move |g| (m, g)))
                    .collect();
                let done: Vec<_> = jobs
                    .par_iter()
                    .with_max_len(1)
                    .map(|&(m, g)| self.slopes(p, groups[g], motions[m]))
                    .collect::<Result<_, _>>()?;
                let mut out = Vec::with_capacity(motions.len());
                for (m, parts) in done.chunks(groups.len()).enumerate() {
                    let n = motions[m].len();
                    let mut matrix = vec![0.0; n * columns];
                    for (g, (_, slopes)) in parts.iter().enumerate() {
                        let first = g * LANES;
                        let width = groups[g].len();
                        for (i, lanes) in slopes.iter().enumerate() {
                            let row = i * columns + first;
                            matrix[row..row + width].copy_from_slice(&lanes[..width]);
                        }
                    }
                    out.push((parts[0].0.clone(), matrix, n));
                }
                Ok(out)
            })
            .map_err(refused)?;
        runs.into_iter()
            .map(|(values, matrix, n)| {
                let shaped = numpy::ndarray::Array2::from_shape_vec((n, columns), matrix)
                    .map_err(|e| PyValueError::new_err(e.to_string()))?;
                Ok((values.into_pyarray(py), shaped.into_pyarray(py)))
            })
            .collect()
    }
}
