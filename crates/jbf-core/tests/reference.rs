//! Tests of the journal law without inertia at the time step of a control loop, 2 ms, and of the
//! orders of the explicit methods.
//!
//! The reference is an independent implementation (order 8, rtol 1e-13).

mod common;

use common::drive::drive;
use common::law;
use common::table::rows;
use jbf_core::law::journal::State;
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Stepper};
use jbf_core::{Clock, Real};
use nalgebra::Vector2;

const AMPLITUDE_M_S: f64 = 0.127;
const LOOP_STEP_S: f64 = 0.002;

/// Reference run with its law and motion; rows contain time, speed, eps, phi and friction
/// coefficient.
struct Run {
    omega_rad_s: f64,
    clock: Clock,
    rows: Vec<[f64; 5]>,
}

impl Run {
    fn speed_m_s(&self, time_s: f64) -> f64 {
        AMPLITUDE_M_S * (self.omega_rad_s * time_s).sin()
    }

    /// Friction coefficients at the rows of a reference run, computed in steps of `step_s`.
    fn friction<T: Real>(&self, stepper: &impl Stepper, step_s: f64) -> Vec<f64> {
        let law = law::<T>(self.clock);
        let mut state = law.start(T::of(common::LOAD_N));
        let mut from = 0.0;
        let mut out = Vec::new();
        for &[time, speed, ..] in &self.rows {
            drive(&law, stepper, &mut state, [from, time], step_s, |t| {
                self.speed_m_s(t)
            });
            from = time;
            let speed = T::of(speed);
            out.push(law.friction(&state, speed).along(speed.sign()).value());
        }
        out
    }

    /// Fastest change of the unsigned friction coefficient between adjacent steps of a loop, 1/s.
    fn fastest_change_1_s(&self) -> f64 {
        let law = law::<f64>(self.clock);
        let mut state = law.start(common::LOAD_N);
        let end = self.rows[self.rows.len() - 1][0];
        let mut before = None;
        let mut fastest = 0.0_f64;
        for i in 0..(end / LOOP_STEP_S) as u32 {
            let t = LOOP_STEP_S * f64::from(i);
            drive(
                &law,
                &Rk4,
                &mut state,
                [t, t + LOOP_STEP_S],
                LOOP_STEP_S,
                |t| self.speed_m_s(t),
            );
            let f = law
                .friction(&state, self.speed_m_s(t + LOOP_STEP_S).abs())
                .along(1.0);
            if let Some(before) = before.replace(f) {
                fastest = fastest.max((f - before).abs() / LOOP_STEP_S);
            }
        }
        fastest
    }
}

fn runs() -> Vec<Run> {
    let run = |omega_rad_s, clock, text| Run {
        omega_rad_s,
        clock,
        rows: rows(text),
    };
    vec![
        run(
            0.1,
            Clock::Journal,
            include_str!("data/reduced_journal_w0.1.csv"),
        ),
        run(
            1.0,
            Clock::Journal,
            include_str!("data/reduced_journal_w1.csv"),
        ),
        run(
            2.0,
            Clock::Journal,
            include_str!("data/reduced_journal_w2.csv"),
        ),
        run(
            0.1,
            Clock::Thesis,
            include_str!("data/reduced_thesis_w0.1.csv"),
        ),
        run(
            1.0,
            Clock::Thesis,
            include_str!("data/reduced_thesis_w1.csv"),
        ),
        run(
            2.0,
            Clock::Thesis,
            include_str!("data/reduced_thesis_w2.csv"),
        ),
    ]
}

#[test]
fn runge_kutta_at_2_ms_matches_the_reference_to_1e_6() {
    for run in runs() {
        let got = run.friction::<f64>(&Rk4, LOOP_STEP_S);
        for (row, f) in run.rows.iter().zip(got) {
            let error = (f - row[4]).abs();
            assert!(
                error < 1e-6,
                "{:?} w = {}: {row:?} {error:e}",
                run.clock,
                run.omega_rad_s
            );
        }
    }
}

/// With short steps, only the ten digits of the reference limit the accuracy.
///
/// The remaining error at 2 ms is that of steps across the kink of |U| at a reversal. The short
/// steps are much shorter than the time constant of the film.
#[test]
fn runge_kutta_with_short_steps_converges_to_the_reference() {
    for run in runs() {
        let got = run.friction::<f64>(&Rk4, LOOP_STEP_S / 64.0);
        for (row, f) in run.rows.iter().zip(got) {
            assert!(
                (f - row[4]).abs() < 1e-9,
                "{:?} {}: {row:?}",
                run.clock,
                run.omega_rad_s
            );
        }
    }
}

/// The error of Euler's method is within its theoretical bound and proportional to the step h.
///
/// For a stable film with the impulse response K, the error obeys `e' = -lambda e - (h/2) x''`, so
/// `e = -(h/2) int K x''`. Integration by parts, with K falling from one to zero, results in the
/// bound `(h/2) max|x'| (1 + 1 + 1)`: the end, the start and the integral.
#[test]
fn euler_error_is_within_its_theoretical_bound() {
    for run in runs() {
        let bound = 1.5 * LOOP_STEP_S * run.fastest_change_1_s();
        let worst = |step_s| {
            let got = run.friction::<f64>(&Euler, step_s);
            let errors = run.rows.iter().zip(got).map(|(row, f)| (f - row[4]).abs());
            errors.fold(0.0, f64::max)
        };
        let (whole, half) = (worst(LOOP_STEP_S), worst(LOOP_STEP_S / 2.0));
        assert!(
            whole < bound,
            "{:?} {}: {whole:e} {bound:e}",
            run.clock,
            run.omega_rad_s
        );
        assert!((1.9..2.1).contains(&(whole / half)), "{}", whole / half);
    }
}

/// The errors with three steps on a smooth motion show the orders of both methods.
///
/// The motion is in one direction, always in mixed lubrication, so that neither |U| nor the
/// asperity load has a kink.
#[test]
fn euler_and_runge_kutta_have_their_order_on_a_smooth_motion() {
    fn ends(stepper: &impl Stepper, step_s: f64) -> Vector2<f64> {
        let law = law::<f64>(Clock::Journal);
        let steady = law.steady(0.03).expect("a speed");
        let mut state = State::at(steady.eps, steady.phi_rad, law.nominal());
        drive(&law, stepper, &mut state, [0.0, 1.2], step_s, |t| {
            0.03 + 0.01 * (4.0 * t).sin()
        });
        state.xy()
    }
    fn order(stepper: &impl Stepper, step_s: f64) -> f64 {
        let exact = ends(&Rk4, 1e-4);
        let error = |h| (ends(stepper, h) - exact).norm();
        (error(step_s) / error(step_s / 2.0)).log2()
    }
    for step_s in [4e-3, 2e-3] {
        let p = order(&Euler, step_s);
        assert!((p - 1.0).abs() < 0.05, "Euler {p}");
    }
    for step_s in [4e-2, 2e-2] {
        let p = order(&Rk4, step_s);
        assert!((p - 4.0).abs() < 0.3, "Runge-Kutta {p}");
    }
}

/// Single precision is within 1e-4 of the peak of the loop, also with very short steps.
///
/// In the shortest steps, the film changes by less than a unit in the last place. Without
/// compensated summation, the error at 0.1 ms would be 4e-3.
#[test]
fn single_precision_agrees_with_double_at_any_step() {
    for run in runs() {
        for step_s in [LOOP_STEP_S, LOOP_STEP_S / 20.0, LOOP_STEP_S / 100.0] {
            let double = run.friction::<f64>(&Rk4, step_s);
            let single = run.friction::<f32>(&Rk4, step_s);
            let peak = double.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
            for (a, b) in double.iter().zip(single) {
                let error = (a - b).abs() / peak;
                assert!(
                    error < 1e-4,
                    "{:?} {} {step_s} s: {error:e}",
                    run.clock,
                    run.omega_rad_s
                );
            }
        }
    }
}
