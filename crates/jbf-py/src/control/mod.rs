//! Simulation of a control loop for Python: settings and reference as input, arrays as output.

mod bench;
mod compensators;
pub mod constants;
mod learning;
mod model;
mod observed;
mod plant;
mod running;
mod settings;

use crate::bearing::refused;
use crate::names;
use bench::{Faults, Log, Noise};
use jbf_core::reference::Reference;
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use running::Stepping;
use settings::LoopSpec;

/// Values and rates of a periodic reference at `samples` time steps of `dt_s`, from time zero.
#[pyfunction]
#[pyo3(signature = (wave, low, high, frequency_rad_s, dt_s, samples))]
#[allow(clippy::type_complexity)]
pub fn control_reference<'py>(
    py: Python<'py>,
    wave: &str,
    low: f64,
    high: f64,
    frequency_rad_s: f64,
    dt_s: f64,
    samples: usize,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
    let wave = names::wave(wave)?;
    let reference = Reference::new(wave, low, high, frequency_rad_s).map_err(refused)?;
    let points: Vec<_> = (0..samples)
        .map(|i| reference.at(i as f64 * dt_s))
        .collect();
    let value: Vec<f64> = points.iter().map(|p| p.value).collect();
    let rate: Vec<f64> = points.iter().map(|p| p.rate).collect();
    Ok((value.into_pyarray(py), rate.into_pyarray(py)))
}

/// Simulates a control loop; every array has one value per time step.
#[pyfunction]
#[pyo3(signature = (plant, loop_settings, compensator, reference, rate, load_n, faults, *, precision))]
#[allow(clippy::too_many_arguments)]
pub fn control_run<'py>(
    py: Python<'py>,
    plant: plant::PlantSpec,
    loop_settings: LoopSpec,
    compensator: compensators::Spec,
    reference: PyReadonlyArray1<'py, f64>,
    rate: PyReadonlyArray1<'py, f64>,
    load_n: PyReadonlyArray1<'py, f64>,
    faults: Faults,
    precision: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let contiguous = |_| PyValueError::new_err("arrays must be contiguous");
    let reference = reference.as_slice().map_err(contiguous)?;
    let rate = rate.as_slice().map_err(contiguous)?;
    let load = load_n.as_slice().map_err(contiguous)?;
    if rate.len() != reference.len() || load.len() != reference.len() {
        return Err(PyValueError::new_err(
            "reference, rate and load must have equal length",
        ));
    }
    let mut looped: Box<dyn Stepping> = match precision {
        "f64" => compensator.into_loop::<f64>(&loop_settings)?,
        "f32" => compensator.into_loop::<f32>(&loop_settings)?,
        other => {
            return Err(PyValueError::new_err(format!(
                "precision {other:?} is not known: f64 or f32"
            )))
        }
    };
    let log = py.detach(|| -> PyResult<Log> {
        let first_load = load.first().copied().unwrap_or(0.0);
        let mut shaft = plant.build(loop_settings.dt_s, first_load)?;
        let noise = Noise::new(&plant);
        Ok(bench::run(
            shaft.as_mut(),
            looped.as_mut(),
            &plant,
            noise,
            [reference, rate, load],
            &faults,
        ))
    })?;
    log.into_dict(py)
}
