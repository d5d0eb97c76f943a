//! Tests that a control loop in single precision does not change over a billion steps (23 days):
//! late periods equal early ones.
//!
//! The default test has a million steps. A period of the target is a whole number of steps and
//! moves the shaft by a constant angle, so that periods can be compared. A change of the mean error
//! shows drift; a change of the RMS shows an oscillation or a loss of learned values.

mod common;

use common::bench::{controller, coulomb, learning, observed, plant, Bench, Control, DT_S};
use jbf_core::compensator::Compensator;
use jbf_core::controller::Controller;
use std::time::Instant;

/// Number of steps of a period of the target.
///
/// `LAPS` is the number of periods that are compared.
const LAP: u64 = 1000;
const LAPS: u64 = 50;

/// Number of periods until learning has settled.
const SETTLED: u64 = 200;

/// Mean and RMS of the tracking error.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    sum: f64,
    squares: f64,
}

impl Errors {
    fn add(&mut self, error: f64) {
        self.sum += error;
        self.squares += error * error;
    }

    fn mean(&self) -> f64 {
        self.sum / (LAP * LAPS) as f64
    }

    fn rms(&self) -> f64 {
        (self.squares / (LAP * LAPS) as f64).sqrt()
    }
}

/// Runs a loop for `steps` steps and returns the tracking errors of periods after learning has
/// settled and of the last periods.
fn run<C: Compensator<f32>>(
    control: Control,
    controller: Controller<f32, C>,
    steps: u64,
) -> [Errors; 2] {
    let mut bench = Bench::new(plant(&[]), controller);
    let mut seen = [Errors::default(); 2];
    let targets: Vec<(f64, f64)> = (0..LAP)
        .map(|i| {
            let rate = core::f64::consts::TAU / (LAP as f64 * DT_S);
            let phase = rate * i as f64 * DT_S;
            match control {
                // With an offset: the shaft turns continuously, and the counter rolls over.
                Control::Velocity => (2.0 + 3.0 * phase.sin(), 3.0 * rate * phase.cos()),
                Control::Position => (phase.sin(), rate * phase.cos()),
            }
        })
        .collect();
    let windows = [SETTLED * LAP, steps - LAPS * LAP];
    for i in 0..steps {
        let (value, rate) = targets[(i % LAP) as usize];
        let there = match control {
            Control::Position => bench.shaft.angle_rad,
            Control::Velocity => bench.shaft.speed_rad_s,
        };
        let error = there - value;
        for (errors, from) in seen.iter_mut().zip(windows) {
            if (from..from + LAPS * LAP).contains(&i) {
                errors.add(error);
            }
        }
        bench.step(value, rate);
    }
    seen
}

fn as_it_was<C: Compensator<f32>>(
    name: &str,
    control: Control,
    controller: Controller<f32, C>,
    steps: u64,
) {
    let begun = Instant::now();
    let [early, late] = run(control, controller, steps);
    println!(
        "{name}: {steps} steps in {:.0} s; mean {:.6} then {:.6}, RMS {:.6} then {:.6}",
        begun.elapsed().as_secs_f64(),
        early.mean(),
        late.mean(),
        early.rms(),
        late.rms()
    );
    assert!(
        (late.rms() / early.rms() - 1.0).abs() < 0.02,
        "{name}: {early:?} {late:?}"
    );
    assert!(
        (late.mean() - early.mean()).abs() < 0.01 * early.rms(),
        "{name}: {early:?} {late:?}"
    );
}

#[test]
fn loop_state_does_not_drift_over_a_million_steps() {
    for control in [Control::Velocity, Control::Position] {
        as_it_was(
            "observed",
            control,
            controller(control, observed(control)),
            1_000_000,
        );
    }
    let control = Control::Velocity;
    as_it_was(
        "coulomb",
        control,
        controller(control, coulomb()),
        1_000_000,
    );
    as_it_was(
        "learning",
        control,
        controller(control, learning(control)),
        1_000_000,
    );
}

/// The loop state does not drift over a billion steps.
///
/// `cargo test --release -p jbf-core --test endless -- --ignored --nocapture`; the variable
/// `JBF_STEPS` sets a smaller number of steps.
#[test]
#[ignore = "forty minutes: make test-extended"]
fn loop_state_does_not_drift_over_a_billion_steps() {
    let asked = std::env::var("JBF_STEPS").map(|n| n.parse().expect("a number"));
    let control = Control::Velocity;
    as_it_was(
        "observed",
        control,
        controller(control, observed(control)),
        asked.unwrap_or(1_000_000_000),
    );
}
