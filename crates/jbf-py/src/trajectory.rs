//! Trajectories to a tolerance: many runs at once, each its own thread's work.

use jbf_core::driver::{follow, Cost, Film, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters, START_PHI_RAD};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock, ParameterError};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use rayon::prelude::*;

/// An imposed speed: `(amplitude, omega, bias)` of a sine, or the times and speeds of a record.
#[derive(FromPyObject)]
pub enum Imposed {
    Sine((f64, f64, f64)),
    Record((Vec<f64>, Vec<f64>)),
}

/// One run: where its samples are, and its motion.
struct Run {
    time_s: Vec<f64>,
    imposed: Imposed,
    start: Start<f64>,
}

/// What one run gives.
struct Result1 {
    coefficient: Vec<f64>,
    x: Vec<f64>,
    y: Vec<f64>,
    cost: Cost,
}

/// Friction coefficient, eps cos(phi), eps sin(phi), steps.
type Columns<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    u32,
);

fn refused(error: ParameterError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

fn one<F: Film<f64, N>, const N: usize>(
    film: &F,
    run: &Run,
    tolerance: f64,
) -> Result<Result1, ParameterError> {
    let n = run.time_s.len();
    let mut coefficient = vec![0.0; n];
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    let sink = |i: usize, sample: &Sample<f64>| {
        coefficient[i] = sample.coefficient;
        [x[i], y[i]] = sample.xy;
    };
    let (start, times) = (&run.start, &run.time_s);
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
        cost,
    })
}

fn all<F: Film<f64, N> + Sync, const N: usize>(
    film: &F,
    runs: &[Run],
    tolerance: f64,
) -> Result<Vec<Result1>, ParameterError> {
    runs.par_iter()
        .with_max_len(1)
        .map(|run| one(film, run, tolerance))
        .collect()
}

/// Follow each of `runs`, `(sample times, motion)`, to about `tolerance` in friction.
#[pyfunction]
#[pyo3(signature = (runs, *, model, clock, tolerance, start_time_s, start_eps, start_phi_rad, f_m,
                    u_tr_m_s, k0, gamma, radius_m, length_m, clearance_m, mass_kg, count,
                    viscosity_pa_s, load_n))]
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
) -> PyResult<Vec<Columns<'py>>> {
    let bearing = Bearing {
        radius_m,
        length_m,
        clearance_m,
        mass_kg,
        count,
        viscosity_pa_s,
    };
    let parameters = Parameters {
        f_m,
        u_tr_m_s,
        k0,
        gamma,
    };
    let clock = Clock::from_name(clock).ok_or_else(|| {
        PyValueError::new_err(format!("clock {clock:?} is neither journal nor thesis"))
    })?;
    let start = Start {
        time_s: start_time_s.unwrap_or(0.0),
        eps: start_eps,
        phi_rad: start_phi_rad.unwrap_or(START_PHI_RAD),
    };
    let runs: Vec<Run> = runs
        .into_iter()
        .map(|(time_s, imposed)| Run {
            time_s: time_s.as_array().iter().copied().collect(),
            imposed,
            start,
        })
        .collect();
    let done = match model {
        "journal" => {
            let film = Journal::new(&bearing, load_n, &parameters, clock).map_err(refused)?;
            py.detach(|| all(&film, &runs, tolerance))
        }
        "journal_full" => {
            let film = JournalFull::new(&bearing, load_n, &parameters, clock).map_err(refused)?;
            py.detach(|| all(&film, &runs, tolerance))
        }
        _ => {
            return Err(PyValueError::new_err(format!(
                "model {model:?} is neither journal nor journal_full"
            )))
        }
    };
    Ok(done
        .map_err(refused)?
        .into_iter()
        .map(|run| {
            (
                run.coefficient.into_pyarray(py),
                run.x.into_pyarray(py),
                run.y.into_pyarray(py),
                run.cost.steps,
            )
        })
        .collect())
}
