//! A law with effects, over whole runs: prediction and its derivatives.

use crate::bearing::{refused, Sizes};
use crate::motion::Motion;
use crate::pool::on_pool;
use crate::share::longest_first;
use jbf_batch::Simd;
use jbf_core::effect::{Effects, Info, Rig, CATALOGUE};
use jbf_core::law::{self, with_law, Named, Visitor};
use jbf_core::{run, Bearing, Clock, Dual, ParameterError, Real};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Derivatives carried side by side in one pass: a law's own, or those of a law with effects. A
/// pass of eight costs a quarter more than one of four, one of twelve three quarters of two passes.
const FEW: usize = 4;
const MANY: usize = 8;
const MOST: usize = 12;

/// A friction law and effects round it; parameters come with each call.
#[pyclass(frozen, module = "jbf._core")]
pub struct Chain {
    law: &'static law::Info,
    bearing: Option<Bearing>,
    load_n: Option<f64>,
    clock: Clock,
    effects: Vec<&'static Info>,
    max_step_s: f64,
}

/// Runs a chain round whatever law it is handed, and gives every reading to `sink`.
struct Runs<'a, T: Real, R> {
    effects: Effects<T>,
    rig: Rig<T>,
    run: R,
    max_step_s: f64,
    motions: &'a [&'a Motion],
}

/// What becomes of one run's readings.
trait Reader<T>: Sync {
    type Read: Send;
    fn simd() -> Simd {
        Simd::Baseline
    }
    fn read(&self, samples: usize, predict: impl FnOnce(&mut dyn FnMut(usize, T))) -> Self::Read;
}

/// Values of a run, and the derivatives of each with respect to some parameters, row by row.
type Slice = (Vec<f64>, Vec<f64>);

/// Readings alone.
struct Values;

impl Reader<f64> for Values {
    type Read = Vec<f64>;
    fn read(&self, samples: usize, predict: impl FnOnce(&mut dyn FnMut(usize, f64))) -> Vec<f64> {
        let mut values = vec![0.0; samples];
        predict(&mut |i, f| values[i] = f);
        values
    }
}

/// Readings and their derivatives.
struct Slopes;

impl<const LANES: usize> Reader<Dual<LANES>> for Slopes {
    type Read = (Vec<f64>, Vec<[f64; LANES]>);
    fn simd() -> Simd {
        Simd::best()
    }
    fn read(
        &self,
        samples: usize,
        predict: impl FnOnce(&mut dyn FnMut(usize, Dual<LANES>)),
    ) -> Self::Read {
        let mut values = vec![0.0; samples];
        let mut slopes = vec![[0.0; LANES]; samples];
        predict(&mut |i, f| {
            values[i] = f.value;
            slopes[i] = f.slope;
        });
        (values, slopes)
    }
}

impl<T: Real, R: Reader<T>> Visitor<T> for Runs<'_, T, R> {
    type Output = Vec<R::Read>;

    fn visit<L: Named<T>>(self, law: L) -> Self::Output {
        let chain = jbf_core::Chain {
            law,
            effects: self.effects,
            rig: self.rig,
        };
        let simd = R::simd();
        self.motions
            .par_iter()
            .with_max_len(1)
            .map(|motion| {
                self.run.read(motion.len(), |sink| {
                    simd.dispatch(
                        #[inline(always)]
                        || run::predict(&chain, &motion.record(), self.max_step_s, sink),
                    );
                })
            })
            .collect()
    }
}

/// The fastest rate of the film along any of the motions, 1/s.
struct FilmRate<'a> {
    effects: Effects<f64>,
    rig: Rig<f64>,
    motions: &'a [&'a Motion],
}

impl Visitor<f64> for FilmRate<'_> {
    type Output = f64;

    fn visit<L: Named<f64>>(self, law: L) -> f64 {
        let chain = jbf_core::Chain {
            law,
            effects: self.effects,
            rig: self.rig,
        };
        let rates = self
            .motions
            .iter()
            .map(|motion| run::film_rate_1_s(&chain, &motion.record()));
        rates.fold(0.0, f64::max)
    }
}

impl Chain {
    fn count(&self) -> usize {
        let theirs = self.effects.iter().map(|e| e.parameters.len());
        self.law.parameters.len() + theirs.sum::<usize>()
    }

    /// Run the chain with one set of parameter values along motions.
    fn runs<T: Real, R: Reader<T>>(
        &self,
        p: &[T],
        run: R,
        motions: &[&Motion],
    ) -> Result<Vec<R::Read>, ParameterError> {
        let (effects, rig) = self.around(p)?;
        let max_step_s = self.max_step_s;
        let visitor = Runs {
            effects,
            rig,
            run,
            max_step_s,
            motions,
        };
        self.with_law(p, visitor)
    }

    /// What stands round the law: effects with their parameters, and the rig.
    fn around<T: Real>(&self, p: &[T]) -> Result<(Effects<T>, Rig<T>), ParameterError> {
        let mut rest = &p[self.law.parameters.len()..];
        let mut effects = Effects::NONE;
        for info in &self.effects {
            let (values, after) = rest.split_at(info.parameters.len());
            effects.set(info.name, values)?;
            rest = after;
        }
        // Without a bearing the axis is a linear one: a rotary one of radius 1 m.
        let bearing = self.bearing.as_ref();
        let rig = Rig {
            radius_m: T::of(bearing.map_or(1.0, |b| b.radius_m)),
            count: T::of(bearing.map_or(1.0, |b| f64::from(b.count))),
        };
        Ok((effects, rig))
    }

    fn with_law<T: Real, V: Visitor<T>>(
        &self,
        p: &[T],
        visitor: V,
    ) -> Result<V::Output, ParameterError> {
        with_law(
            self.law.name,
            self.bearing.as_ref(),
            self.load_n,
            &p[..self.law.parameters.len()],
            self.clock,
            visitor,
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

    /// Values and derivatives with respect to at most `MOST` parameters along one run.
    fn slopes(&self, p: &[f64], which: &[usize], motion: &Motion) -> Result<Slice, ParameterError> {
        match which.len() {
            n if n <= FEW => self.slopes_of::<FEW>(p, which, motion),
            n if n <= MANY => self.slopes_of::<MANY>(p, which, motion),
            _ => self.slopes_of::<MOST>(p, which, motion),
        }
    }

    fn slopes_of<const LANES: usize>(
        &self,
        p: &[f64],
        which: &[usize],
        motion: &Motion,
    ) -> Result<Slice, ParameterError> {
        let lifted: Vec<Dual<LANES>> = p
            .iter()
            .enumerate()
            .map(|(i, &v)| match which.iter().position(|&w| w == i) {
                Some(lane) => Dual::parameter(v, lane),
                None => Dual::of(v),
            })
            .collect();
        let mut runs = self.runs(&lifted, Slopes, &[motion])?;
        let (values, lanes) = runs.swap_remove(0);
        let rows = lanes.iter().flat_map(|row| row[..which.len()].iter());
        Ok((values, rows.copied().collect()))
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
        let law = law::CATALOGUE
            .iter()
            .find(|info| info.name == law)
            .ok_or_else(|| PyValueError::new_err(format!("law {law:?} is not in the catalogue")))?;
        let bearing = bearing.map(Sizes::checked).transpose()?;
        if law.needs_bearing && (bearing.is_none() || load_n.is_none()) {
            return Err(PyValueError::new_err(format!(
                "the law {} needs a bearing and load_n",
                law.name
            )));
        }
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
            .map(|name| applicable(name, law))
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

    /// Dotted names of the parameters, in the order of every array here.
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
            .detach(|| on_pool(|| self.runs(p, Values, &motions)))
            .map_err(refused)?;
        Ok(runs.into_iter().map(|v| v.into_pyarray(py)).collect())
    }

    /// Fastest rate of the law's film along any of the motions, 1/s. Beyond
    /// `FASTEST_FILM_1_S` a prediction does not follow it.
    fn film_rate_1_s(
        &self,
        parameters: PyReadonlyArray1<'_, f64>,
        motions: Vec<Py<Motion>>,
    ) -> PyResult<f64> {
        let p = self.checked(&parameters)?;
        let motions: Vec<&Motion> = motions.iter().map(Py::get).collect();
        let (effects, rig) = self.around(p).map_err(refused)?;
        let visitor = FilmRate {
            effects,
            rig,
            motions: &motions,
        };
        self.with_law(p, visitor).map_err(refused)
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
                on_pool(|| {
                    let groups: Vec<&[usize]> = match columns {
                        0 => vec![&[]],
                        MANY..=MOST => vec![&which],
                        _ => which.chunks(MANY).collect(),
                    };
                    let jobs: Vec<(usize, usize)> = (0..motions.len())
                        .flat_map(|m| (0..groups.len()).map(move |g| (m, g)))
                        .collect();
                    let done = longest_first(
                        &jobs,
                        |&(m, _)| motions[m].len(),
                        |&(m, g)| self.slopes(p, groups[g], motions[m]),
                    )?;
                    let mut out = Vec::with_capacity(motions.len());
                    let mut done = done.into_iter();
                    for motion in &motions {
                        let n = motion.len();
                        let mut parts: Vec<Slice> = done.by_ref().take(groups.len()).collect();
                        let matrix = side_by_side(&parts, n, columns);
                        out.push((parts.swap_remove(0).0, matrix, n));
                    }
                    Ok(out)
                })
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

/// One matrix of `n` rows out of blocks of columns.
fn side_by_side(parts: &[Slice], n: usize, columns: usize) -> Vec<f64> {
    if let [(_, only)] = parts {
        return only.clone();
    }
    let mut matrix = vec![0.0; n * columns];
    let mut first = 0;
    for (values, slopes) in parts {
        let width = slopes.len() / values.len().max(1);
        if width > 0 {
            for (row, own) in matrix.chunks_mut(columns).zip(slopes.chunks(width)) {
                row[first..first + width].copy_from_slice(own);
            }
        }
        first += width;
    }
    matrix
}

/// The effect of that name, if it goes with the law.
fn applicable(name: &str, law: &law::Info) -> PyResult<&'static Info> {
    let info = CATALOGUE
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| PyValueError::new_err(format!("effect {name:?} is not in the catalogue")))?;
    match info.lacking(law) {
        None => Ok(info),
        Some(need) => Err(PyValueError::new_err(format!(
            "effect {name} does not apply: the law {} {}",
            law.name,
            need.why_not()
        ))),
    }
}
