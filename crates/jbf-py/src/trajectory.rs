//! Trajectories of a film with a given accuracy: many runs in parallel.

mod lanes;

use crate::names;
use crate::pool::on_pool;
use jbf_core::driver::{follow, Cost, Film, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock, Dual, Error, Real};
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// Imposed speed: amplitude (m/s), angular frequency (rad/s) and bias (m/s) of a sine, or the times
/// (s) and speeds (m/s) of a record.
#[derive(FromPyObject)]
pub enum Imposed {
    Sine((f64, f64, f64)),
    Record((Vec<f64>, Vec<f64>)),
}

/// Run to be integrated: its sample times (s) and its imposed speed.
struct Run {
    time_s: Vec<f64>,
    imposed: Imposed,
}

/// Number type of the integration, without or with derivatives.
trait Number: Real + Send + Sync {
    fn slopes(&self) -> &[f64];

    /// Integrates a film without inertia along all runs.
    fn reduced(
        film: &Journal<Self>,
        runs: &[Run],
        start: &Start<Self>,
        tolerance: f64,
    ) -> Result<Vec<Result1>, Error> {
        all(film, runs, start, tolerance)
    }
}

impl Number for f64 {
    fn slopes(&self) -> &[f64] {
        &[]
    }

    fn reduced(
        film: &Journal<f64>,
        runs: &[Run],
        start: &Start<f64>,
        tolerance: f64,
    ) -> Result<Vec<Result1>, Error> {
        lanes::all_in_lanes(film, runs, start, tolerance)
    }
}

impl<const N: usize> Number for Dual<N> {
    fn slopes(&self) -> &[f64] {
        &self.slope
    }
}

/// Result of one run: samples, derivatives and cost.
struct Result1 {
    coefficient: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    /// Derivatives of the friction coefficient, one row per sample.
    slopes: Vec<f64>,
    cost: Cost,
}

/// Arrays of one run: friction coefficient, eps cos(phi), eps sin(phi), number of steps, and, if
/// requested, derivatives with respect to f_m, U_tr, K0 and gamma.
type Columns<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    u32,
    Option<Bound<'py, PyArray2<f64>>>,
);

fn refused(error: Error) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn one<T: Number, F: Film<T, N>, const N: usize>(
    film: &F,
    run: &Run,
    start: &Start<T>,
    tolerance: f64,
) -> Result<Result1, Error> {
    let n = run.time_s.len();
    let mut coefficient = vec![0.0; n];
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    let mut slopes = Vec::new();
    let sink = |i: usize, sample: &Sample<T>| {
        coefficient[i] = sample.coefficient.value();
        [x[i], y[i]] = sample.xy.map(T::value).into();
        slopes.extend_from_slice(sample.coefficient.slopes());
    };
    let times = &run.time_s;
    let cost = match &run.imposed {
        &Imposed::Sine((amplitude, omega, bias)) => {
            let motion = Sine::with_bias(amplitude, omega, bias)?;
            follow(film, &motion, start, times, tolerance, sink)?
        }
        Imposed::Record((time_s, velocity_m_s)) => {
            let motion = Sampled::new(time_s, velocity_m_s)?;
            follow(film, &motion, start, times, tolerance, sink)?
        }
    };
    Ok(Result1 {
        coefficient,
        x,
        y,
        slopes,
        cost,
    })
}

fn all<T: Number, F: Film<T, N> + Sync, const N: usize>(
    film: &F,
    runs: &[Run],
    start: &Start<T>,
    tolerance: f64,
) -> Result<Vec<Result1>, Error> {
    runs.par_iter()
        .with_max_len(1)
        .map(|run| one(film, run, start, tolerance))
        .collect()
}

/// Settings that all runs share, except the parameters of the law.
struct Asked {
    bearing: Bearing,
    load_n: f64,
    clock: Clock,
    with_inertia: bool,
    start_time_s: f64,
    start_eps: Option<f64>,
    start_phi_rad: f64,
    tolerance: f64,
}

impl Asked {
    fn follow<T: Number>(
        &self,
        parameters: &Parameters<T>,
        runs: &[Run],
    ) -> Result<Vec<Result1>, Error> {
        let (load_n, clock) = (self.load_n, self.clock);
        let start = Start {
            time_s: self.start_time_s,
            eps: self.start_eps.map(T::of),
            phi_rad: T::of(self.start_phi_rad),
        };
        if self.with_inertia {
            let film = JournalFull::new(&self.bearing, load_n, parameters, clock)?;
            all(&film, runs, &start, self.tolerance)
        } else {
            let film = Journal::new(&self.bearing, load_n, parameters, clock)?;
            T::reduced(&film, runs, &start, self.tolerance)
        }
    }
}

/// Integrates a film along each of `runs`, `(sample times, motion)`, with an error of the friction
/// coefficient of about `tolerance`.
///
/// With `derivatives`, the function also returns the derivatives of the friction coefficient with
/// respect to f_m, U_tr, K0 and gamma, exact for the steps taken.
#[pyfunction]
#[pyo3(signature = (runs, *, model, clock, tolerance, start_time_s, start_eps, start_phi_rad, f_m,
                    u_tr_m_s, k0, gamma, radius_m, length_m, clearance_m, mass_kg, count,
                    viscosity_pa_s, load_n, derivatives=false))]
#[allow(clippy::too_many_arguments)]
pub fn trajectories<'py>(
    py: Python<'py>,
    runs: Vec<(PyReadonlyArray1<'py, f64>, Imposed)>,
    model: &str,
    clock: &str,
    tolerance: f64,
    start_time_s: Option<f64>,
    start_eps: Option<f64>,
    start_phi_rad: Option<f64>,
    f_m: f64,
    u_tr_m_s: f64,
    k0: f64,
    gamma: f64,
    radius_m: f64,
    length_m: f64,
    clearance_m: f64,
    mass_kg: f64,
    count: u32,
    viscosity_pa_s: f64,
    load_n: f64,
    derivatives: bool,
) -> PyResult<Vec<Columns<'py>>> {
    let bearing = Bearing::new()
        .with_radius_m(radius_m)
        .with_length_m(length_m)
        .with_clearance_m(clearance_m)
        .with_mass_kg(mass_kg)
        .with_count(count)
        .with_viscosity_pa_s(viscosity_pa_s);
    let clock = names::clock(clock)?;
    if !["journal", "journal_full"].contains(&model) {
        return Err(PyValueError::new_err(format!(
            "model {model:?} is not known: journal or journal_full"
        )));
    }
    let asked = Asked {
        bearing,
        load_n,
        clock,
        with_inertia: model == "journal_full",
        start_time_s: start_time_s.unwrap_or(0.0),
        start_eps,
        start_phi_rad: start_phi_rad.unwrap_or(Start::<f64>::default().phi_rad),
        tolerance,
    };
    let runs: Vec<Run> = runs
        .into_iter()
        .map(|(time_s, imposed)| Run {
            time_s: time_s.as_array().iter().copied().collect(),
            imposed,
        })
        .collect();
    let values = [f_m, u_tr_m_s, k0, gamma];
    let done = py.detach(|| {
        on_pool(|| {
            if derivatives {
                let lifted = |i: usize| Dual::<LANES>::parameter(values[i], i);
                asked.follow(&named([lifted(0), lifted(1), lifted(2), lifted(3)]), &runs)
            } else {
                asked.follow(&named(values), &runs)
            }
        })
    });
    done.map_err(refused)?
        .into_iter()
        .map(|run| {
            let n = run.coefficient.len();
            let slopes = derivatives
                .then(|| Array2::from_shape_vec((n, LANES), run.slopes))
                .transpose()
                .map_err(|e| PyValueError::new_err(e.to_string()))?;
            Ok((
                run.coefficient.into_pyarray(py),
                run.x.into_pyarray(py),
                run.y.into_pyarray(py),
                run.cost.steps,
                slopes.map(|m| m.into_pyarray(py)),
            ))
        })
        .collect()
}

/// Number of parameters of the journal law, and of derivatives of a dual number.
const LANES: usize = 4;

fn named<T>([f_m, u_tr_m_s, k0, gamma]: [T; LANES]) -> Parameters<T> {
    Parameters {
        f_m,
        u_tr_m_s,
        k0,
        gamma,
    }
}
