//! Simulated shaft with any friction law, passed from Python.

use super::model::{ModelSpec, Using};
use crate::bearing::refused;
use jbf_core::law::{Law, Named};
use jbf_core::plant::{Drive, Plant, State};
use jbf_core::Chain;
use pyo3::prelude::*;

/// Motor and shaft, from a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct DriveSpec {
    damping_1_s: f64,
    input_rad_s2_v: f64,
    volts_per_n: f64,
    limit_v: f64,
}

impl DriveSpec {
    /// Returns the drive in the form of `jbf_core`.
    pub fn drive(&self) -> Drive {
        Drive::new(self.damping_1_s, self.input_rad_s2_v)
            .with_volts_per_n(self.volts_per_n)
            .with_limit_v(self.limit_v)
    }
}

/// Simulated shaft with its drive and friction, from a dictionary with these keys.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PlantSpec {
    model: ModelSpec,
    drive: DriveSpec,
    pub counts_per_rad: f64,
    pub counter_bits: u32,
    pub input_noise_v: f64,
    pub encoder_noise_counts: f64,
    pub seed: u64,
    stood_s: f64,
    inner_steps: u32,
}

/// Simulated shaft in the course of a run, with any law.
pub trait Shaft {
    /// Advances by one time step of the loop under an input (V) and a load (N).
    fn tick(&mut self, input_v: f64, load_n: f64);
    /// Returns the present angle (rad), speed (rad/s) and friction (V).
    fn now(&self) -> [f64; 3];
}

struct Running<L: Law<f64>> {
    plant: Plant<f64, L>,
    state: State<f64, L::State>,
    inner_steps: u32,
}

impl<L: Law<f64>> Shaft for Running<L> {
    fn tick(&mut self, input_v: f64, load_n: f64) {
        for _ in 0..self.inner_steps {
            self.plant.step(&mut self.state, input_v, load_n);
        }
    }

    fn now(&self) -> [f64; 3] {
        let s = &self.state;
        [s.angle_rad, s.speed_rad_s, s.friction_v]
    }
}

struct Build<'a> {
    spec: &'a PlantSpec,
    dt_s: f64,
    load_n: f64,
}

impl Using<f64> for Build<'_> {
    type Output = PyResult<Box<dyn Shaft>>;

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> Self::Output {
        let s = self.spec;
        let step_s = self.dt_s / f64::from(s.inner_steps);
        let plant = Plant::new(chain, s.drive.drive(), step_s).map_err(refused)?;
        let state = plant.start(self.load_n, s.stood_s);
        Ok(Box::new(Running {
            plant,
            state,
            inner_steps: s.inner_steps,
        }))
    }
}

impl PlantSpec {
    /// Creates the shaft at rest, after a rest of the specified duration.
    pub fn build(&self, dt_s: f64, load_n: f64) -> PyResult<Box<dyn Shaft>> {
        let spec = self;
        self.model.chain(Build { spec, dt_s, load_n })?
    }
}
