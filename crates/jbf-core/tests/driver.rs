//! Tests of trajectories against those of an independent implementation.
//!
//! Every tolerance and every kind of motion is tested.

mod common;

use common::random::Random;
use common::table::rows;
use common::{law, table_4_2, LOAD_N};
use jbf_core::driver::{follow, trajectory, Excitation, Film, Function, Sampled, Sine, Start};
use jbf_core::law::journal::Parameters;
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::{Bearing, Clock, Dual, Real};

const AMPLITUDE_M_S: f64 = 0.127;

fn full(clock: Clock) -> JournalFull<f64> {
    JournalFull::new(&Bearing::THESIS, LOAD_N, &table_4_2(), clock).expect("Table 4.2 is valid")
}

/// Reference trajectory with its law and motion; rows contain time, speed, eps, phi and friction
/// coefficient.
struct Run {
    omega_rad_s: f64,
    clock: Clock,
    rows: Vec<[f64; 5]>,
}

macro_rules! run {
    ($clock:ident, $name:literal, $omega:literal) => {
        Run {
            omega_rad_s: $omega,
            clock: Clock::$clock,
            rows: rows(include_str!(concat!("data/", $name, ".csv"))),
        }
    };
}

fn reduced_runs() -> Vec<Run> {
    vec![
        run!(Journal, "reduced_journal_w0.1", 0.1),
        run!(Journal, "reduced_journal_w1", 1.0),
        run!(Journal, "reduced_journal_w2", 2.0),
        run!(Thesis, "reduced_thesis_w0.1", 0.1),
        run!(Thesis, "reduced_thesis_w1", 1.0),
        run!(Thesis, "reduced_thesis_w2", 2.0),
    ]
}

fn full_runs() -> Vec<Run> {
    vec![
        run!(Journal, "full_journal_w0.1", 0.1),
        run!(Journal, "full_journal_w1", 1.0),
        run!(Journal, "full_journal_w2", 2.0),
        run!(Thesis, "full_thesis_w0.1", 0.1),
        run!(Thesis, "full_thesis_w1", 1.0),
        run!(Thesis, "full_thesis_w2", 2.0),
    ]
}

/// Largest errors of friction coefficient, eps and phi over the rows of a reference trajectory.
fn errors<F: Film<f64, N>, const N: usize>(film: &F, run: &Run, tolerance: f64) -> [f64; 3] {
    let motion = Sine::new(AMPLITUDE_M_S, run.omega_rad_s).expect("valid");
    let times: Vec<f64> = run.rows.iter().map(|row| row[0]).collect();
    let mut worst = [0.0_f64; 3];
    let start = Start::default();
    follow(film, &motion, &start, &times, tolerance, |i, sample| {
        let [_, speed, eps, phi, f] = run.rows[i];
        // Friction is set-valued at a reversal.
        let df = if speed.abs() < 1e-9 {
            0.0
        } else {
            sample.coefficient - f
        };
        let all = [df, sample.eps - eps, sample.xy.y.atan2(sample.xy.x) - phi];
        for (w, e) in worst.iter_mut().zip(all) {
            *w = w.max(e.abs());
        }
    })
    .expect("a tolerance");
    worst
}

#[test]
fn trajectory_of_the_reduced_model_agrees_with_the_reference_to_1e_9() {
    for run in reduced_runs() {
        let [f, eps, phi] = errors(&law(run.clock), &run, 1e-9);
        let name = format!("{:?} {}", run.clock, run.omega_rad_s);
        assert!(
            f < 1e-9 && eps < 1e-9 && phi < 1e-8,
            "{name}: {f:e} {eps:e} {phi:e}"
        );
    }
}

#[test]
fn trajectory_of_the_full_model_agrees_with_the_reference_to_1e_7() {
    for run in full_runs() {
        let [f, eps, phi] = errors(&full(run.clock), &run, 1e-8);
        let name = format!("{:?} {}", run.clock, run.omega_rad_s);
        assert!(
            f < 1e-7 && eps < 1e-7 && phi < 1e-6,
            "{name}: {f:e} {eps:e} {phi:e}"
        );
    }
}

/// Asserts that every tolerance from 1e-3 to 1e-12 succeeds.
///
/// The error must be below a few tolerances, and decrease until it reaches the accuracy `digits` of
/// the reference.
fn falls_with_the_tolerance<F: Film<f64, N>, const N: usize>(film: &F, run: &Run, digits: f64) {
    let mut best = f64::INFINITY;
    for tenth in 6..=24 {
        let tolerance = 10.0_f64.powf(-0.5 * f64::from(tenth));
        let [f, ..] = errors(film, run, tolerance);
        let name = format!("{:?} {} at {tolerance:e}", run.clock, run.omega_rad_s);
        assert!(f < 10.0 * tolerance + digits, "{name}: {f:e}");
        assert!(f < 8.0 * best + digits, "{name}: {f:e} after {best:e}");
        best = best.min(f);
    }
    assert!(
        best < digits,
        "{:?} {}: {best:e}",
        run.clock,
        run.omega_rad_s
    );
}

#[test]
fn trajectory_error_decreases_with_the_tolerance() {
    for run in reduced_runs() {
        falls_with_the_tolerance(&law(run.clock), &run, 2e-12);
    }
    for run in full_runs() {
        falls_with_the_tolerance(&full(run.clock), &run, 1e-8);
    }
}

/// Friction is the same for a motion given as a formula with its kinks, as a function without known
/// reversals, and as a dense record.
#[test]
fn friction_is_the_same_for_three_forms_of_one_motion() {
    let film = law::<f64>(Clock::Journal);
    let (a, w, b) = (0.1, 1.3, 0.04);
    let times: Vec<f64> = (1..400).map(|i| 0.0251 * f64::from(i)).collect();
    let along = |motion: &dyn Excitation| {
        let mut out = vec![0.0; times.len()];
        trajectory(&film, &Dyn(motion), &times, 1e-9, &mut out).expect("a tolerance");
        out
    };
    let exact = along(&Sine::with_bias(a, w, b).expect("valid"));
    let function = along(&Function {
        velocity_m_s: |t: f64| b + a * (w * t).sin(),
        acceleration_m_s2: |t: f64| a * w * (w * t).cos(),
    });
    let grid: Vec<f64> = (0..=20_000).map(|i| 5.1e-4 * f64::from(i)).collect();
    let speeds: Vec<f64> = grid.iter().map(|t| b + a * (w * t).sin()).collect();
    let record = along(&Sampled::new(&grid, &speeds).expect("valid"));
    for i in 0..times.len() {
        assert!(
            (exact[i] - function[i]).abs() < 2e-9,
            "function at {}",
            times[i]
        );
        // Linear interpolation over 0.5 ms has an error of w^2 a h^2/8 = 5e-9 m/s.
        assert!(
            (exact[i] - record[i]).abs() < 1e-6,
            "record at {}",
            times[i]
        );
    }
}

/// Motion behind a reference, because `Excitation` is not implemented for references.
struct Dyn<'a>(&'a dyn Excitation);

impl Excitation for Dyn<'_> {
    fn velocity_m_s(&self, t: f64) -> f64 {
        self.0.velocity_m_s(t)
    }
    fn acceleration_m_s2(&self, t: f64) -> f64 {
        self.0.acceleration_m_s2(t)
    }
    fn next_kink_s(&self, t: f64) -> f64 {
        self.0.next_kink_s(t)
    }
}

/// The trajectory of a record with rests and reversals agrees with steps of constant length.
#[test]
fn trajectory_with_rests_agrees_with_steps_of_constant_length() {
    let film = full(Clock::Journal);
    let (t, v) = (
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        [0.0, 0.0, 0.1, 0.0, 0.0, -0.1],
    );
    let motion = Sampled::new(&t, &v).expect("valid");
    let times: Vec<f64> = (0..=60).map(|i| 0.1 * f64::from(i)).collect();
    let mut out = [0.0; 61];
    let cost = trajectory(&film, &motion, &times, 1e-8, &mut out).expect("a tolerance");
    assert!(cost.steps < 3000 && cost.forced == 0, "{cost:?}");
    assert!(
        out[5] == 0.0 && out[35] == 0.0,
        "at rest friction is set-valued"
    );
    assert!(out[15] > 0.0 && out[45] < 0.0 && out[60] < 0.0);
    // Follow this motion in steps of constant length.
    let mut state = film.start(LOAD_N);
    let h = 1e-4;
    for i in 0..60_000 {
        let at = [0.0, 0.5, 1.0].map(|s| motion.velocity_m_s(h * (f64::from(i) + s)).abs());
        film.advance(&mut state, at, 1.0, h);
        if (i + 1) % 1000 == 0 {
            let k = ((i + 1) / 1000) as usize;
            let u = motion.velocity_m_s(times[k]);
            let f = film.friction(&state, u).along(u.sign());
            assert!((f - out[k]).abs() < 1e-6, "at {}: {f} {}", times[k], out[k]);
        }
    }
}

/// Derivatives of a trajectory match central differences, because its steps depend on the values
/// alone.
#[test]
fn trajectory_derivatives_match_central_differences() {
    let motion = Sine::new(AMPLITUDE_M_S, 1.0).expect("valid");
    let times: Vec<f64> = (1..40).map(|i| 0.17 * f64::from(i)).collect();
    let p = [0.26, 0.06, 7.5e5, 33.0];
    let run = |p: [Dual<4>; 4]| {
        let parameters = Parameters {
            f_m: p[0],
            u_tr_m_s: p[1],
            k0: p[2],
            gamma: p[3],
        };
        let film = jbf_core::law::journal::Journal::new(
            &Bearing::THESIS,
            LOAD_N,
            &parameters,
            Clock::Journal,
        )
        .expect("valid");
        let mut out = vec![Dual::ZERO; times.len()];
        trajectory(&film, &motion, &times, 1e-10, &mut out).expect("a tolerance");
        out
    };
    let exact = run(core::array::from_fn(|i| Dual::parameter(p[i], i)));
    for k in 0..4 {
        let nudged = |by: f64| {
            run(core::array::from_fn(|i| {
                Dual::of(if i == k { p[i] * (1.0 + by) } else { p[i] })
            }))
        };
        let (up, down) = (nudged(1e-4), nudged(-1e-4));
        for i in 0..times.len() {
            let difference = (up[i].value - down[i].value) / 2e-4;
            let slope = exact[i].slope[k] * p[k];
            assert!(
                (slope - difference).abs() < 2e-5,
                "{k} at {}: {slope} {difference}",
                times[i]
            );
        }
    }
}

/// Every trajectory ends with finite numbers, also for laws far from that of Cohn (1998).
#[test]
fn trajectory_of_any_law_at_any_tolerance_ends_with_finite_numbers() {
    let mut random = Random::new(21);
    let times: Vec<f64> = (1..50).map(|i| 0.1 * f64::from(i)).collect();
    let mut out = vec![0.0; times.len()];
    for round in 0..400 {
        let p = Parameters {
            f_m: random.log_uniform(1e-3, 1.0),
            u_tr_m_s: random.log_uniform(1e-3, 1.0),
            k0: random.log_uniform(1e3, 1e9),
            gamma: random.log_uniform(0.1, 1e3),
        };
        let bearing = Bearing::THESIS.with_mass_kg(random.log_uniform(0.01, 100.0));
        let load_n = random.log_uniform(5.0, 2000.0);
        let clock = if random.chance(0.5) {
            Clock::Journal
        } else {
            Clock::Thesis
        };
        let amplitude = p.u_tr_m_s * random.log_uniform(0.1, 20.0);
        let omega = random.log_uniform(0.1, 20.0);
        let bias = if random.chance(0.5) {
            0.0
        } else {
            amplitude * random.uniform(-1.5, 1.5)
        };
        let motion = Sine::with_bias(amplitude, omega, bias).expect("valid");
        let tolerance = random.log_uniform(1e-9, 1e-2);
        let name = format!("{round}: {p:?} {load_n} N {clock:?} {motion:?} {tolerance:e}");
        let full = JournalFull::new(&bearing, load_n, &p, clock).expect("valid");
        let cost = trajectory(full.reduced(), &motion, &times, tolerance, &mut out).expect("runs");
        assert!(
            cost.steps < 1_000_000 && cost.forced == 0,
            "{name}: {cost:?}"
        );
        assert!(out.iter().all(|f| f.is_finite()), "{name}");
        let cost = trajectory(&full, &motion, &times, tolerance, &mut out).expect("runs");
        assert!(
            cost.steps < 1_000_000 && cost.forced == 0,
            "full {name}: {cost:?}"
        );
        assert!(out.iter().all(|f| f.is_finite()), "full {name}");
    }
}

#[test]
fn invalid_argument_of_a_trajectory_is_refused_by_name() {
    let film = law::<f64>(Clock::Journal);
    let motion = Sine::new(0.1, 1.0).expect("valid");
    let mut out = [0.0; 2];
    let mut name = |times: &[f64], tolerance: f64| {
        let refused = trajectory(&film, &motion, times, tolerance, &mut out);
        refused.expect_err("refused").name()
    };
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(name(&[0.0, 1.0], tolerance), "tolerance");
    }
    for times in [[-1.0, 1.0], [1.0, 0.5], [0.0, f64::NAN]] {
        assert_eq!(name(&times, 1e-6), "times_s");
    }
    assert_eq!(
        Sine::new(-0.1, 1.0).expect_err("refused").name(),
        "amplitude_m_s"
    );
    assert_eq!(
        Sine::new(0.1, 0.0).expect_err("refused").name(),
        "omega_rad_s"
    );
    let nan = f64::NAN;
    assert_eq!(
        Sine::with_bias(0.1, 1.0, nan).expect_err("refused").name(),
        "bias_m_s"
    );
    assert_eq!(
        Sampled::new(&[0.0], &[0.0]).expect_err("refused").name(),
        "samples"
    );
    assert_eq!(
        Sampled::new(&[0.0, 0.0], &[0.0, 1.0])
            .expect_err("refused")
            .name(),
        "time_s"
    );
    let start = Start {
        eps: Some(1.5),
        ..Start::default()
    };
    let refused = follow(&film, &motion, &start, &[1.0], 1e-6, |_, _| {});
    assert_eq!(refused.expect_err("refused").name(), "eps");
    assert!(trajectory(&film, &motion, &[], 1e-6, &mut out).is_ok());
    assert!(trajectory(&film, &motion, &[0.0, 0.0], 1e9, &mut out).is_ok());
}
