//! Time of a trajectory to a tolerance: two periods of U = 0.127 sin(w t), with 2000 samples in the
//! second period.
//!
//! The two cases are the tasks T2 (reduced, 1e-6) and T3 (with inertia, 1e-5) of `peers.py`.

use criterion::Criterion;
use jbf_benches::{law, LOAD_N};
use jbf_core::driver::{trajectory, Film, Sine};
use jbf_core::law::journal::Parameters;
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock};
use std::f64::consts::TAU;

fn follow<F: Film<f64, N>, const N: usize>(
    c: &mut Criterion,
    name: &str,
    film: &F,
    omega_rad_s: f64,
    tolerance: f64,
) {
    let motion = Sine::new(0.127, omega_rad_s).expect("valid");
    let period = TAU / omega_rad_s;
    let times_s: Vec<f64> = (0..2000)
        .map(|i| period * (1.0 + f64::from(i) / 1999.0))
        .collect();
    let mut friction = vec![0.0; times_s.len()];
    c.bench_function(name, |b| {
        b.iter(|| trajectory(film, &motion, &times_s, tolerance, &mut friction));
    });
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    let c = &mut criterion;
    let reduced = law(|_, v| v);
    let full = JournalFull::new(
        &Bearing::THESIS,
        LOAD_N,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )
    .expect("Table 4.2 is valid");
    for omega_rad_s in [0.0055, 0.25, 2.0] {
        let name = |law: &str| format!("driver/{law}/{omega_rad_s}_rad_s");
        follow(c, &name("journal"), &reduced, omega_rad_s, 1e-6);
        follow(c, &name("journal_full"), &full, omega_rad_s, 1e-5);
    }
    criterion.final_summary();
}
