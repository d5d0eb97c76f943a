//! Steps the model with the inertia of the journal in a control loop of 2 ms.
//!
//! An explicit step would have to be shorter than the fastest time constant of the model, ten
//! nanoseconds at very low speed. The example prints the friction, that of a trajectory accurate to
//! 1e-8, and the time per step.
//!
//! `cargo run --release -p jbf-core --example implicit_full_2ms`

use jbf_core::driver::{trajectory, Sine};
use jbf_core::law::journal::Parameters;
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::stepper::{Rodas3, Rodas5P, StiffStepper};
use jbf_core::{Bearing, Clock, Error};
use std::time::Instant;

const DT_S: f64 = 0.002;
const STEPS: usize = 3140;

/// Returns the friction coefficient after each step, and the mean time per step, ns.
fn run(law: &JournalFull<f64>, stepper: &impl StiffStepper) -> (Vec<f64>, f64) {
    let speeds: Vec<f64> = (0..=2 * STEPS)
        .map(|i| 0.127 * (0.5 * DT_S * i as f64 * 2.0).sin())
        .collect();
    let mut f = vec![0.0; STEPS];
    let mut state = law.start(104.0);
    let clock = Instant::now();
    for (i, f) in f.iter_mut().enumerate() {
        let u = [speeds[2 * i], speeds[2 * i + 1], speeds[2 * i + 2]];
        law.advance_with(stepper, &mut state, u.map(f64::abs), 1.0, DT_S);
        *f = law.friction(&state, u[2]).along(u[2].signum());
    }
    (f, clock.elapsed().as_secs_f64() * 1e9 / STEPS as f64)
}

fn main() -> Result<(), Error> {
    let (bearing, table) = (Bearing::THESIS, Parameters::TABLE_4_2);
    let law = JournalFull::new(&bearing, 104.0, &table, Clock::Journal)?;
    let times: Vec<f64> = (1..=STEPS).map(|i| DT_S * i as f64).collect();
    let mut exact = vec![0.0; STEPS];
    trajectory(&law, &Sine::new(0.127, 2.0)?, &times, 1e-8, &mut exact)?;
    let (third, ns) = run(&law, &Rodas3);
    let (fifth, more_ns) = run(&law, &Rodas5P);

    println!("{:>6}  {:>9}  {:>9}", "t, s", "2 ms loop", "exact");
    for i in (0..STEPS).step_by(200) {
        println!("{:6.3}  {:9.6}  {:9.6}", times[i], third[i], exact[i]);
    }
    let peak = exact.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    let worst = |f: &[f64]| {
        let errors = f.iter().zip(&exact).map(|(a, b)| (a - b).abs());
        errors.fold(0.0, f64::max) / peak
    };
    println!(
        "Rodas3 (the law's own): {:.1e} of the peak, {ns:.0} ns per step",
        worst(&third)
    );
    println!(
        "Rodas5P:                {:.1e} of the peak, {more_ns:.0} ns per step",
        worst(&fifth)
    );
    Ok(())
}
