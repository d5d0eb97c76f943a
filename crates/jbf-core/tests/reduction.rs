//! Tests of the journal law without inertia against that with inertia, with trajectories at a
//! tolerance of 1e-9.
//!
//! Cohn (1998) calls the difference negligible. The expected values are from an independent
//! implementation.

mod common;

use common::{law, table_4_2, LOAD_N};
use jbf_core::driver::{trajectory, Sine};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock};

/// Largest difference of the unsigned friction coefficient over the second period of `U = 0.127
/// sin(w t)`, relative to the peak of the loop.
fn difference(clock: Clock, omega_rad_s: f64) -> f64 {
    let full = JournalFull::new(&Bearing::THESIS, LOAD_N, &table_4_2(), clock).expect("valid");
    let reduced = law::<f64>(clock);
    let motion = Sine::new(0.127, omega_rad_s).expect("valid");
    let period = core::f64::consts::TAU / omega_rad_s;
    let times: Vec<f64> = (1..4000)
        .map(|i| period * (1.0 + f64::from(i) / 4000.0))
        .collect();
    let (mut a, mut b) = (vec![0.0_f64; times.len()], vec![0.0_f64; times.len()]);
    trajectory(&full, &motion, &times, 1e-9, &mut a).expect("a tolerance");
    trajectory(&reduced, &motion, &times, 1e-9, &mut b).expect("a tolerance");
    let peak = a.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    let apart = a.iter().zip(&b).map(|(a, b)| (a.abs() - b.abs()).abs());
    apart.fold(0.0, f64::max) / peak
}

#[test]
fn difference_between_reduced_and_full_model_equals_the_independent_value() {
    let omegas = [0.1, 0.25, 1.0, 2.0];
    for (clock, expected) in [
        (Clock::Thesis, [1.1e-5, 3.4e-5, 1.9e-4, 4.5e-4]),
        (Clock::Journal, [2.0e-6, 5.4e-6, 2.8e-5, 6.6e-5]),
    ] {
        for (omega, expected) in omegas.into_iter().zip(expected) {
            let got = difference(clock, omega);
            // The expected values have two digits.
            assert!(
                (got / expected - 1.0).abs() < 0.05,
                "{clock:?} {omega}: {got:e}"
            );
        }
    }
}
