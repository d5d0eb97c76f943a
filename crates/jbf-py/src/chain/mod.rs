//! Python class of a law with effects: prediction along whole runs, and its derivatives.

mod film;
mod names;
mod runs;
mod slopes;

use crate::bearing::{refused, Sizes};
use crate::film_paths::FilmPath;
use crate::motion::Motion;
use crate::names::clock as clock_named;
use crate::pool::on_pool;
use crate::share::longest_first;
use jbf_core::effect::Info;
use jbf_core::law;
use jbf_core::{Bearing, Clock, Error};
use jbf_predict::Model;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use runs::{FilmRate, InnerSteps};

/// Friction law with effects; parameter values are passed with each call.
#[pyclass(frozen, module = "jbf._core")]
pub struct Chain {
    law: &'static law::Info,
    bearing: Option<Bearing>,
    load_n: Option<f64>,
    clock: Clock,
    effects: Vec<&'static Info>,
    max_step_s: f64,
}

impl Chain {
    fn count(&self) -> usize {
        let theirs = self.effects.iter().map(|e| e.parameters.len());
        self.law.parameters.len() + theirs.sum::<usize>()
    }

    /// Returns law and effects as a prediction model.
    fn model(&self) -> Model<'_> {
        Model {
            law: self.law,
            bearing: self.bearing.as_ref(),
            load_n: self.load_n,
            clock: self.clock,
            effects: &self.effects,
            max_step_s: self.max_step_s,
        }
    }

    /// Computes the readings (N) along each motion, without derivatives.
    fn values(&self, p: &[f64], motions: &[&Motion]) -> Result<Vec<Vec<f64>>, Error> {
        let paths = self.film_paths(p, false, motions)?;
        let jobs: Vec<_> = motions.iter().zip(&paths).collect();
        longest_first(
            &jobs,
            |(motion, _)| motion.len(),
            |(motion, path)| {
                let path = path.as_deref().map(FilmPath::kept);
                self.model().readings(p, &motion.record(), path)
            },
        )
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
}

#[pymethods]
impl Chain {
    #[new]
    #[pyo3(signature = (*, law, bearing, load_n, clock, effects, max_step_s))]
    fn new(
        law: &str,
        bearing: Option<Sizes>,
        load_n: Option<f64>,
        clock: &str,
        effects: Vec<String>,
        max_step_s: f64,
    ) -> PyResult<Self> {
        let law = names::law(law)?;
        let bearing = bearing.map(Sizes::checked).transpose()?;
        if law.needs_bearing && (bearing.is_none() || load_n.is_none()) {
            return Err(PyValueError::new_err(format!(
                "the law {} needs a bearing and load_n",
                law.name
            )));
        }
        let clock = clock_named(clock)?;
        if !(max_step_s > 0.0 && max_step_s.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "max_step_s = {max_step_s} must be positive and finite"
            )));
        }
        let effects = effects
            .iter()
            .map(|name| names::effect(name, law))
            .collect::<PyResult<Vec<_>>>()?;
        Ok(Self {
            law,
            bearing,
            load_n,
            clock,
            effects,
            max_step_s,
        })
    }

    /// Names of the parameters, in the order of every array of this class.
    ///
    /// The parameters of the law come first. Those of an effect have the form `effect.parameter`.
    #[getter]
    fn parameter_names(&self) -> Vec<String> {
        let own = self.law.parameters.iter().map(|p| p.name.to_string());
        let theirs = self.effects.iter().flat_map(|e| {
            e.parameters
                .iter()
                .map(|p| format!("{}.{}", e.name, p.name))
        });
        own.chain(theirs).collect()
    }

    /// Computes the friction readings, N, one array per run.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        parameters: PyReadonlyArray1<'py, f64>,
        motions: Vec<Py<Motion>>,
    ) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let p = self.checked(&parameters)?;
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let runs = py
            .detach(|| on_pool(|| self.values(p, &motions)))
            .map_err(refused)?;
        Ok(runs.into_iter().map(|v| v.into_pyarray(py)).collect())
    }

    /// Fastest rate at which the film of the law responds along any of the motions, 1/s.
    ///
    /// A prediction does not resolve films with rates above `FASTEST_FILM_1_S`.
    fn film_rate_1_s(
        &self,
        parameters: PyReadonlyArray1<'_, f64>,
        motions: Vec<Py<Motion>>,
    ) -> PyResult<f64> {
        let p = self.checked(&parameters)?;
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let film_rate = FilmRate { motions: &motions };
        self.model().with_chain(p, film_rate).map_err(refused)
    }

    /// Number of inner steps of a prediction along all motions, a measure of the computing time.
    fn inner_steps(
        &self,
        parameters: PyReadonlyArray1<'_, f64>,
        motions: Vec<Py<Motion>>,
    ) -> PyResult<f64> {
        let p = self.checked(&parameters)?;
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let counted = InnerSteps {
            motions: &motions,
            max_step_s: self.max_step_s,
        };
        self.model().with_chain(p, counted).map_err(refused)
    }

    /// Computes the readings (N) and their derivatives with respect to the parameters `which`.
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
        let runs = py
            .detach(|| on_pool(|| self.all_slopes(p, &which, &motions)))
            .map_err(refused)?;
        runs.into_iter()
            .map(|(values, matrix)| {
                let shape = (values.len(), which.len());
                let shaped = numpy::ndarray::Array2::from_shape_vec(shape, matrix)
                    .map_err(|e| PyValueError::new_err(e.to_string()))?;
                Ok((values.into_pyarray(py), shaped.into_pyarray(py)))
            })
            .collect()
    }
}
