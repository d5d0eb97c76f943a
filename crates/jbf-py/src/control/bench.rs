//! Simulation of a control loop: shaft, encoder, noise, faults, and the log of a run.

use super::plant::{PlantSpec, Shaft};
use super::running::Stepping;
use jbf_core::reference::Target;
use numpy::IntoPyArray;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::rand_core::SeedableRng;
use rand_pcg::Pcg64Mcg;

/// Encoder faults, by the index of the time step; a fault after the end of the run does not occur.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Faults {
    /// Step from which the counter is frozen, and step at which it recovers.
    frozen: (usize, usize),
    /// Step at which the counter jumps.
    jump_at: usize,
    /// Size of the jump in counts.
    jump_counts: i64,
}

/// Random number generator for noise, with the same numbers for a seed on every machine.
pub struct Noise {
    random: Pcg64Mcg,
    input_v: f64,
    encoder_counts: f64,
}

impl Noise {
    pub fn new(spec: &PlantSpec) -> Self {
        Self {
            random: Pcg64Mcg::seed_from_u64(spec.seed),
            input_v: spec.input_noise_v,
            encoder_counts: spec.encoder_noise_counts,
        }
    }

    fn of(&mut self, sigma: f64) -> f64 {
        if sigma > 0.0 {
            let z: f64 = StandardNormal.sample(&mut self.random);
            sigma * z
        } else {
            0.0
        }
    }
}

macro_rules! log {
    ($($name:ident),* $(,)?) => {
        /// Recorded signals of a run, with one value per time step.
        #[derive(Default)]
        pub struct Log {
            $($name: Vec<f64>,)*
            status: Vec<u8>,
        }

        impl Log {
            fn with_capacity(n: usize) -> Self {
                Self { $($name: Vec::with_capacity(n),)* status: Vec::with_capacity(n) }
            }

            pub fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
                let dict = PyDict::new(py);
                $(dict.set_item(stringify!($name), self.$name.into_pyarray(py))?;)*
                dict.set_item("status", self.status.into_pyarray(py))?;
                Ok(dict)
            }
        }
    };
}

log! {
    angle_rad, velocity_rad_s, friction_v,
    measured_angle_rad, estimated_velocity_rad_s, error, base_v, compensation_v,
    estimated_friction_v, correction_v, forward_v, output_v, learned_0, learned_1,
}

/// Simulates the loop along a reference (value, rate) and a load (N), with one sample per time
/// step.
pub fn run(
    shaft: &mut dyn Shaft,
    looped: &mut dyn Stepping,
    spec: &PlantSpec,
    mut noise: Noise,
    [reference, rate, load_n]: [&[f64]; 3],
    faults: &Faults,
) -> Log {
    let n = reference.len();
    let mut log = Log::with_capacity(n);
    let mask = u32::MAX >> (32 - spec.counter_bits.clamp(1, 32));
    let (mut shown, mut shifted) = (0_i64, 0_i64);
    for i in 0..n {
        let [angle_rad, velocity_rad_s, friction_v] = shaft.now();
        let jitter = noise.of(noise.encoder_counts);
        if i == faults.jump_at {
            shifted = faults.jump_counts;
        }
        if !(faults.frozen.0..faults.frozen.1).contains(&i) {
            shown = (angle_rad * spec.counts_per_rad + jitter).floor() as i64 + shifted;
        }
        let target = Target {
            value: reference[i],
            rate: rate[i],
        };
        let parts = looped.step(shown as u32 & mask, target);
        let disturbance = noise.of(noise.input_v);
        shaft.tick(parts.output_v + disturbance, load_n[i]);
        let answer = parts.compensation;
        log.angle_rad.push(angle_rad);
        log.velocity_rad_s.push(velocity_rad_s);
        log.friction_v.push(friction_v);
        log.measured_angle_rad.push(parts.angle_rad);
        log.estimated_velocity_rad_s.push(parts.velocity_rad_s);
        log.error.push(parts.error);
        log.base_v.push(parts.base_v);
        log.compensation_v.push(answer.sum_v);
        log.estimated_friction_v.push(answer.friction_v);
        log.correction_v.push(answer.correction_v);
        log.forward_v.push(answer.forward_v);
        log.output_v.push(parts.output_v);
        log.learned_0.push(answer.learned[0]);
        log.learned_1.push(answer.learned[1]);
        log.status.push(parts.status.bits());
    }
    log
}
