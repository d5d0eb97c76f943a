//! Tests of the orders of convergence of the implicit methods; see `reference.rs` for the explicit
//! ones.
//!
//! The motion is smooth: in one direction and always in mixed lubrication, so that neither |U| nor
//! the asperity load has a kink.
//!
//! A method interpolates the input by a parabola through three values in a step. The interpolation
//! error is of third order and odd about the middle, which results in an error of fourth order at
//! the end of the step. A method of order five therefore keeps its order only with a constant
//! input. The integration of trajectories evaluates the excitation itself and always keeps the
//! order.

mod common;

use common::{law, table_4_2, LOAD_N};
use jbf_core::law::journal::State;
use jbf_core::law::journal_full::{self, JournalFull};
use jbf_core::stepper::{Rodas3, Rodas5P, StiffStepper};
use jbf_core::{Bearing, Clock};
use nalgebra::Vector2;

/// State of the film without inertia after a motion of `0.03 + swing sin(4 t)` m/s.
fn reduced(stepper: &impl StiffStepper, step_s: f64, swing: f64) -> Vector2<f64> {
    let law = law::<f64>(Clock::Journal);
    // Away from its steady state, so that it also moves at a steady speed.
    let steady = law.steady(0.025).expect("a speed");
    let mut state = State::at(steady.eps, steady.phi_rad, law.nominal());
    steps(step_s, swing, |speed, h| {
        law.advance_stiff_with(stepper, &mut state, speed, 1.0, h);
    });
    assert_eq!(state.clamped, 0);
    state.xy()
}

/// State of the film with inertia after a motion of `0.03 + swing sin(4 t)` m/s.
fn full(stepper: &impl StiffStepper, step_s: f64, swing: f64) -> Vector2<f64> {
    let law = JournalFull::<f64>::new(&Bearing::THESIS, LOAD_N, &table_4_2(), Clock::Journal)
        .expect("valid");
    let steady = law.reduced().steady(0.025).expect("a speed");
    let mut state = journal_full::State::at(steady.eps, steady.phi_rad, law.reduced().nominal());
    // The rates settle first, in steps that do not depend on `step_s`.
    for _ in 0..100 {
        law.advance_with(&Rodas5P, &mut state, [0.03; 3], 1.0, 1e-5);
    }
    steps(step_s, swing, |speed, h| {
        law.advance_with(stepper, &mut state, speed, 1.0, h);
    });
    assert_eq!(state.clamped, 0);
    state.xy
}

fn steps(step_s: f64, swing: f64, mut advance: impl FnMut([f64; 3], f64)) {
    // At a steady speed the film settles within a second; the error must not decay with the motion.
    let time_s = if swing == 0.0 { 0.16 } else { 1.2 };
    let n = (time_s / step_s).round();
    let h = time_s / n;
    for i in 0..n as u32 {
        let at = |s: f64| 0.03 + swing * (4.0 * h * (f64::from(i) + s)).sin();
        advance([0.0, 0.5, 1.0].map(at), h);
    }
}

fn order(step_s: f64, end: impl Fn(f64) -> Vector2<f64>, exact: Vector2<f64>) -> f64 {
    let error = |h: f64| (end(h) - exact).norm();
    (error(step_s) / error(step_s / 2.0)).log2()
}

#[test]
fn steppers_have_their_order_on_the_reduced_model() {
    for (swing, fifth, longest_s) in [(0.0, 5.0, 0.08), (0.01, 4.0, 0.04)] {
        let exact = reduced(&Rodas5P, 1e-3, swing);
        for step_s in [longest_s, 0.5 * longest_s] {
            let p3 = order(step_s, |h| reduced(&Rodas3, h, swing), exact);
            let p5 = order(step_s, |h| reduced(&Rodas5P, h, swing), exact);
            assert!((p3 - 3.0).abs() < 0.35, "Rodas3 {p3} at {step_s} s");
            assert!((p5 - fifth).abs() < 0.8, "Rodas5P {p5} at {step_s} s");
        }
    }
}

/// Rodas3 keeps its order of three in steps a thousand times longer than the fast time constants;
/// the order of Rodas5P is one below its nominal five.
///
/// Rodas3 meets the order conditions of differential-algebraic systems.
#[test]
fn steppers_have_their_order_on_the_stiff_full_model() {
    for (swing, fifth, longest_s) in [(0.0, 4.0, 0.08), (0.01, 4.0, 0.04)] {
        let exact = full(&Rodas5P, 5e-4, swing);
        for step_s in [longest_s, 0.5 * longest_s] {
            let p3 = order(step_s, |h| full(&Rodas3, h, swing), exact);
            let p5 = order(step_s, |h| full(&Rodas5P, h, swing), exact);
            assert!((p3 - 3.0).abs() < 0.35, "Rodas3 {p3} at {step_s} s");
            assert!((p5 - fifth).abs() < 0.8, "Rodas5P {p5} at {step_s} s");
        }
    }
}
