//! Tests of the journal law with inertia at the time step of a control loop, 2 ms.
//!
//! The reference is an independent implementation (Radau, rtol 1e-10).

mod common;

use common::table::rows;
use common::{table_4_2, LOAD_N};
use jbf_core::law::journal::Parameters;
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::stepper::{Rodas3, Rodas5P, StiffStepper};
use jbf_core::{Bearing, Clock, Dual, Real};

const AMPLITUDE_M_S: f64 = 0.127;
const LOOP_STEP_S: f64 = 0.002;

fn full<T: Real>(clock: Clock) -> JournalFull<T> {
    JournalFull::new(&Bearing::THESIS, LOAD_N, &table_4_2(), clock).expect("Table 4.2 is valid")
}

/// Reference run with its law and motion; rows contain time, speed, eps, phi and friction
/// coefficient.
struct Run {
    omega_rad_s: f64,
    clock: Clock,
    rows: Vec<[f64; 5]>,
}

impl Run {
    /// Friction coefficients at the rows of a reference run, computed in steps of at most `step_s`.
    fn friction<T: Real>(&self, stepper: &impl StiffStepper, step_s: f64) -> Vec<f64> {
        let law = full::<T>(self.clock);
        let mut state = law.start(T::of(LOAD_N));
        let mut from = 0.0;
        let mut out = Vec::new();
        for &[time, speed, ..] in &self.rows {
            let n = ((time - from) / step_s - 1e-9).ceil().max(1.0);
            let h = (time - from) / n;
            for i in 0..n as u32 {
                let t = from + h * f64::from(i);
                let at = [t, t + 0.5 * h, t + h];
                let u = at.map(|t| T::of((AMPLITUDE_M_S * (self.omega_rad_s * t).sin()).abs()));
                law.advance_with(stepper, &mut state, u, T::ONE, T::of(h));
            }
            from = time;
            let speed = T::of(speed);
            let f = law.friction(&state, speed).along(speed.sign());
            out.push(f.value());
        }
        assert_eq!(state.clamped, 0);
        out
    }

    /// Largest error of the friction coefficient relative to the peak of the loop.
    fn worst<T: Real>(&self, stepper: &impl StiffStepper, step_s: f64) -> f64 {
        let got = self.friction::<T>(stepper, step_s);
        let peak = self
            .rows
            .iter()
            .fold(0.0, |m: f64, row| m.max(row[4].abs()));
        let errors = self.rows.iter().zip(got).map(|(row, f)| (f - row[4]).abs());
        errors.fold(0.0, f64::max) / peak
    }
}

macro_rules! run {
    ($clock:ident, $name:literal, $omega:literal) => {
        Run {
            omega_rad_s: $omega,
            clock: Clock::$clock,
            rows: rows(include_str!(concat!("data/full_", $name, ".csv"))),
        }
    };
}

fn runs() -> Vec<Run> {
    vec![
        run!(Journal, "journal_w0.1", 0.1),
        run!(Journal, "journal_w1", 1.0),
        run!(Journal, "journal_w2", 2.0),
        run!(Thesis, "thesis_w0.1", 0.1),
        run!(Thesis, "thesis_w1", 1.0),
        run!(Thesis, "thesis_w2", 2.0),
    ]
}

/// The error at 2 ms is below 5e-5 of the peak; the required value is 1e-4.
///
/// The main causes are steps across the kink of |U| at a reversal (6e-7 if a step ends there), and
/// rounding in single precision.
#[test]
fn error_at_the_loop_step_is_below_5e_5_of_the_peak() {
    for run in runs() {
        let third = run.worst::<f64>(&Rodas3, LOOP_STEP_S);
        let fifth = run.worst::<f64>(&Rodas5P, LOOP_STEP_S);
        let single = run.worst::<f32>(&Rodas3, LOOP_STEP_S);
        let (clock, w) = (run.clock, run.omega_rad_s);
        assert!(third < 2e-5, "{clock:?} {w}: {third:e}");
        assert!(fifth < 2e-5, "{clock:?} {w}: {fifth:e}");
        assert!(single < 5e-5, "{clock:?} {w}: {single:e}");
    }
}

/// The error with short steps is that of the reference, 1e-8.
#[test]
fn short_steps_converge_to_the_reference() {
    for run in runs() {
        let error = run.worst::<f64>(&Rodas5P, LOOP_STEP_S / 64.0);
        assert!(
            error < 1e-7,
            "{:?} {}: {error:e}",
            run.clock,
            run.omega_rad_s
        );
    }
}

/// A law with derivatives has the same values as one without, and the derivatives match
/// differences.
#[test]
fn derivatives_through_the_implicit_step_match_differences() {
    let end = |lift: &dyn Fn(usize, f64) -> Dual<4>| {
        let p = Parameters::TABLE_4_2;
        let parameters = Parameters {
            f_m: lift(0, p.f_m),
            u_tr_m_s: lift(1, p.u_tr_m_s),
            k0: lift(2, p.k0),
            gamma: lift(3, p.gamma),
        };
        let law =
            JournalFull::new(&Bearing::THESIS, LOAD_N, &parameters, Clock::Journal).expect("valid");
        let mut state = law.start(Dual::of(LOAD_N));
        for i in 0..200 {
            let at = [0.0, 0.5, 1.0].map(|s| Dual::of(0.127 * (0.001 * (f64::from(i) + s)).sin()));
            law.advance(&mut state, at, Dual::ONE, Dual::of(LOOP_STEP_S));
        }
        law.friction(&state, Dual::of(0.025)).along(Dual::ONE)
    };
    let exact = end(&|i, v| Dual::parameter(v, i));
    for k in 0..4 {
        let nudged =
            |share: f64| end(&|i, v| Dual::of(if i == k { v * (1.0 + share) } else { v })).value;
        let size = [0.26, 0.06, 7.5e5, 33.0][k];
        let difference = (nudged(1e-5) - nudged(-1e-5)) / (2e-5 * size);
        let error = (exact.slope[k] / difference - 1.0).abs();
        assert!(
            error < 1e-5,
            "parameter {k}: {} {difference}",
            exact.slope[k]
        );
    }
}

/// After a change of load the state reaches the steady state of the new load.
#[test]
fn state_settles_at_the_steady_state_of_a_new_load() {
    let law = full::<f64>(Clock::Journal);
    let mut state = law.start(LOAD_N);
    for load_n in [104.0, 30.0, 150.0, 83.5, 104.0] {
        law.set_load(&mut state, load_n);
        for _ in 0..20_000 {
            law.advance(&mut state, [0.05; 3], 1.0, LOOP_STEP_S);
            assert!(state.eps() > 0.0 && state.eps() < 1.0);
        }
    }
    let steady = law.reduced().steady(0.05).expect("a speed");
    assert!((state.eps() - steady.eps).abs() < 1e-12);
    assert_eq!(state.clamped, 0);
}

/// An invalid mass of a bearing is refused with the name of the parameter.
#[test]
fn invalid_mass_of_a_bearing_is_refused_by_name() {
    for (mass_kg, name) in [(0.0, "mass_kg"), (1e-320, "mass_number")] {
        let bearing = Bearing::THESIS.with_mass_kg(mass_kg);
        let error = JournalFull::new(&bearing, LOAD_N, &table_4_2::<f64>(), Clock::Journal)
            .expect_err(name);
        assert_eq!(error.name(), name);
    }
}
