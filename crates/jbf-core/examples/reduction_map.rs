//! Influence of the inertia of the journal on the friction, for the parameters of Table 4.2 (Cohn
//! 1998) and both time scales of the film.
//!
//! Prints comma-separated values: the largest difference of the friction between the models with
//! and without inertia, over a period of `U = amplitude sin(omega t)` after the initial transient,
//! relative to the peak of the loop.
//!
//! `cargo run --release -p jbf-core --example reduction_map > reduction.csv`

use jbf_core::driver::{trajectory, Film, Sine};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock, Error};
use std::f64::consts::TAU;

const SAMPLES: usize = 1000;
/// Duration of the initial transient in dimensionless time; the longest time constant of the film
/// is about eight.
const SETTLING: f64 = 30.0;

/// Unsigned friction coefficient over the first whole period after the initial transient.
fn loop_of<F: Film<f64, N>, const N: usize>(
    film: &F,
    settling_s: f64,
    amplitude_m_s: f64,
    omega_rad_s: f64,
) -> Result<Vec<f64>, Error> {
    let period = TAU / omega_rad_s;
    let from = (settling_s / period).ceil() * period;
    let times: Vec<f64> = (1..SAMPLES)
        .map(|i| from + period * i as f64 / SAMPLES as f64)
        .collect();
    let mut f = vec![0.0; times.len()];
    let motion = Sine::new(amplitude_m_s, omega_rad_s)?;
    trajectory(film, &motion, &times, 1e-8, &mut f)?;
    Ok(f.into_iter().map(f64::abs).collect())
}

fn main() -> Result<(), Error> {
    println!("clock,amplitude_m_s,omega_rad_s,difference");
    for clock in [Clock::Journal, Clock::Thesis] {
        let (bearing, p) = (Bearing::THESIS, Parameters::TABLE_4_2);
        let full = JournalFull::new(&bearing, 104.0, &p, clock)?;
        let reduced = Journal::new(&bearing, 104.0, &p, clock)?;
        let settling_s = match clock {
            Clock::Journal => SETTLING * bearing.radius_m / p.u_tr_m_s,
            Clock::Thesis => SETTLING,
        };
        for a in 0..=24 {
            let amplitude = 1e-3 * 10.0_f64.powf(f64::from(a) / 8.0);
            for w in 0..=28 {
                let omega = 0.1 * 10.0_f64.powf(f64::from(w) / 8.0);
                let with = loop_of(&full, settling_s, amplitude, omega)?;
                let without = loop_of(&reduced, settling_s, amplitude, omega)?;
                let peak = with.iter().fold(0.0, |m: f64, &f| m.max(f));
                let apart = with.iter().zip(&without).map(|(a, b)| (a - b).abs());
                let difference = apart.fold(0.0, f64::max) / peak;
                println!(
                    "{},{amplitude:.6},{omega:.6},{difference:.3e}",
                    match clock {
                        Clock::Journal => "journal",
                        Clock::Thesis => "thesis",
                    }
                );
            }
        }
    }
    Ok(())
}
