//! Cost and error of trajectories with a given accuracy.
//!
//! There are eight motions in both directions, w = 0.0055 to 2 rad/s, with two periods each and
//! 2000 samples in the second period, for the models with and without inertia. The error is the
//! largest difference of a sample from the same trajectory at a tolerance of 1e-12. Times are those
//! of one thread.
//!
//! `cargo run --release -p jbf-core --example driver_cost`

use jbf_core::driver::{follow, Cost, Film, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock, Error};
use std::f64::consts::TAU;
use std::time::Instant;

const OMEGAS_RAD_S: [f64; 8] = [0.0055, 0.0225, 0.045, 0.1, 0.25, 0.5, 1.0, 2.0];
const SAMPLES: usize = 2000;

/// Computes the friction coefficients of all runs into `out`, one run after another, and returns
/// the total cost.
fn all<F: Film<f64, N>, const N: usize>(
    film: &F,
    tolerance: f64,
    out: &mut [f64],
) -> Result<Cost, Error> {
    let start = Start {
        phi_rad: 0.01,
        ..Start::default()
    };
    let mut sum = Cost::default();
    for (omega, out) in OMEGAS_RAD_S.iter().zip(out.chunks_mut(SAMPLES)) {
        let step = TAU / omega / (SAMPLES - 1) as f64;
        let times: Vec<f64> = (0..SAMPLES)
            .map(|i| TAU / omega + step * i as f64)
            .collect();
        let motion = Sine::new(0.127, *omega)?;
        let cost = follow(film, &motion, &start, &times, tolerance, |i, sample| {
            out[i] = sample.coefficient;
        })?;
        sum.steps += cost.steps;
        sum.rejected += cost.rejected;
        sum.slopes += cost.slopes;
        sum.linearisations += cost.linearisations;
        sum.forced += cost.forced;
    }
    Ok(sum)
}

fn table<F: Film<f64, N>, const N: usize>(name: &str, film: &F) -> Result<(), Error> {
    println!("{name}");
    println!("tolerance     error   steps  rejected  slopes  linearised  forced  time, ms");
    let mut exact = vec![0.0; SAMPLES * OMEGAS_RAD_S.len()];
    all(film, 1e-12, &mut exact)?;
    let mut out = exact.clone();
    for power in 3..=12 {
        let tolerance = 10.0_f64.powi(-power);
        let cost = all(film, tolerance, &mut out)?;
        // At a sample on a reversal the sign of the speed is rounding.
        let error = exact
            .iter()
            .zip(&out)
            .map(|(a, b)| (a.abs() - b.abs()).abs());
        let error = error.fold(0.0, f64::max);
        let rounds = 15;
        let mut best = f64::INFINITY;
        for _ in 0..rounds {
            let clock = Instant::now();
            all(film, tolerance, &mut out)?;
            best = best.min(clock.elapsed().as_secs_f64());
        }
        println!(
            "{tolerance:9.0e}  {error:8.1e}  {:6}  {:8}  {:6}  {:10}  {:6}  {:8.3}",
            cost.steps,
            cost.rejected,
            cost.slopes,
            cost.linearisations,
            cost.forced,
            best * 1e3
        );
    }
    Ok(())
}

fn main() -> Result<(), Error> {
    let (bearing, p) = (Bearing::THESIS, Parameters::TABLE_4_2);
    table(
        "reduced model",
        &Journal::new(&bearing, 104.0, &p, Clock::Journal)?,
    )?;
    table(
        "full model",
        &JournalFull::new(&bearing, 104.0, &p, Clock::Journal)?,
    )
}
