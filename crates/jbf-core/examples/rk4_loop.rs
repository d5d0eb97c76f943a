//! Error of the Runge-Kutta method of a control loop relative to that of the Euler method.
//!
//! The friction along a reversal of U = 0.127 sin(2 t) is compared with a trajectory accurate to
//! 1e-9.
//!
//! `cargo run --release -p jbf-core --example rk4_loop`

use jbf_core::driver::{trajectory, Sine};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Law;
use jbf_core::stepper::Rk4;
use jbf_core::{Bearing, Clock, Error};

const OMEGA_RAD_S: f64 = 2.0;

fn main() -> Result<(), Error> {
    let (bearing, table) = (Bearing::THESIS, Parameters::TABLE_4_2);
    let law = Journal::new(&bearing, 104.0, &table, Clock::Journal)?;
    println!("Runge-Kutta, largest error of f over two periods (the loop's peak is 0.07):");
    for step_ms in [0.5, 1.0, 2.0, 5.0, 10.0] {
        let dt_s = 1e-3 * step_ms;
        let steps = (6.2 / dt_s) as usize;
        let times: Vec<f64> = (1..=steps).map(|i| dt_s * i as f64).collect();
        let mut exact = vec![0.0; steps];
        let motion = Sine::new(0.127, OMEGA_RAD_S)?;
        trajectory(&law, &motion, &times, 1e-9, &mut exact)?;

        let mut state = law.start(104.0);
        let mut worst = 0.0_f64;
        for (t, exact) in times.iter().zip(&exact) {
            let speed = |ago: f64| 0.127 * (OMEGA_RAD_S * (t - ago)).sin();
            let at = [speed(dt_s), speed(0.5 * dt_s), speed(0.0)].map(f64::abs);
            law.advance_with(&Rk4, &mut state, at, 1.0, dt_s);
            let f = law.friction(&state, speed(0.0)).along(speed(0.0).signum());
            worst = worst.max((f - exact).abs());
        }
        println!(
            "  {step_ms:4} ms  {worst:8.1e}  held {} times",
            state.clamped
        );
    }
    Ok(())
}
