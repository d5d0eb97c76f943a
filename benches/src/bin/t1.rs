//! Task T1 of `benches/peers.py`, which runs this program and its Python peers alternately.
//!
//! 50,000 steps of the reduced law along U = 0.127 sin(t/4) at 2 ms, with friction stored at every
//! step. The program reads lines such as `euler f64`, and prints nanoseconds per step and the last
//! friction coefficient.

use jbf_benches::{law, LOAD_N, LOOP_STEP_S};
use jbf_core::law::journal::{Journal, State};
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Stepper};
use jbf_core::Real;
use std::io::{BufRead, Write};
use std::time::Instant;

const STEPS: usize = 50_000;

/// Advances a journal law along a sampled speed and stores the friction coefficient before each
/// step.
///
/// `halves` contains the speed at every half step, m/s.
#[inline(never)]
fn run<T: Real>(
    law: &Journal<T>,
    stepper: &impl Stepper,
    mut state: State<T>,
    halves: &[T],
    friction: &mut [T],
) {
    let dt = T::of(LOOP_STEP_S);
    for (f, u) in friction.iter_mut().zip(halves.windows(3).step_by(2)) {
        *f = law.friction(&state, u[0]).along(u[0].sign());
        let ends = [u[0].abs(), u[1].abs(), u[2].abs()];
        law.advance_with(stepper, &mut state, ends, T::ONE, dt);
    }
}

fn timed<T: Real>(stepper: &impl Stepper) -> (f64, f64) {
    let law = law(|_, v| T::of(v));
    let half_s = 0.5 * LOOP_STEP_S;
    let speed = |i: usize| T::of(0.127 * (0.25 * half_s * i as f64).sin());
    let halves: Vec<T> = (0..=2 * STEPS).map(speed).collect();
    let mut friction = vec![T::ZERO; STEPS];
    let state = law.start(T::of(LOAD_N));
    run(&law, stepper, state, &halves, &mut friction);
    let begin = Instant::now();
    run(&law, stepper, state, &halves, &mut friction);
    let ns = begin.elapsed().as_secs_f64() * 1e9 / STEPS as f64;
    (ns, friction[STEPS - 1].value())
}

fn main() {
    let mut out = std::io::stdout();
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let answer = match line.trim() {
            "euler f64" => timed::<f64>(&Euler),
            "euler f32" => timed::<f32>(&Euler),
            "rk4 f64" => timed::<f64>(&Rk4),
            "rk4 f32" => timed::<f32>(&Rk4),
            other => {
                eprintln!("unknown task: {other}");
                std::process::exit(2);
            }
        };
        writeln!(out, "{} {}", answer.0, answer.1)
            .and_then(|()| out.flush())
            .expect("a reader");
    }
}
