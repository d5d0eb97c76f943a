//! Tests that the film stays finite and the journal inside the bearing for any finite motion, load
//! and step.

mod common;

use common::random::Random;
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4, Rodas3, Rodas5P, Stepper, StiffStepper};
use jbf_core::{Bearing, Clock, Real};

const LAWS: u32 = 500;
const STEPS: u32 = 1000;

/// Journal law with random parameters over many decades.
fn random_law<T: Real>(random: &mut Random) -> Journal<T> {
    let p = Parameters {
        f_m: T::of(random.log_uniform(1e-4, 10.0)),
        u_tr_m_s: T::of(random.log_uniform(1e-5, 1e2)),
        k0: T::of(random.log_uniform(1.0, 1e12)),
        gamma: T::of(random.log_uniform(1e-3, 1e5)),
    };
    let clock = if random.chance(0.5) {
        Clock::Journal
    } else {
        Clock::Thesis
    };
    let load_n = random.log_uniform(1.0, 1e4);
    Journal::new(&Bearing::THESIS, load_n, &p, clock).expect("in the catalogue's bounds")
}

/// Asserts that the journal stays inside the bearing in half a million random steps.
///
/// Speeds are up to 1e6 m/s and steps up to 10 s. Loads jump by a factor of a hundred, become zero,
/// and change sign.
fn torture<T: Real>(stepper: &impl Stepper, seed: u64) {
    let mut random = Random::new(seed);
    let mut held = 0_u32;
    for _ in 0..LAWS {
        let law = random_law::<T>(&mut random);
        let base_n = random.log_uniform(1.0, 1e4);
        let mut state = law.start(T::of(base_n));
        for _ in 0..STEPS {
            if random.chance(0.05) {
                let jumps = [1.0, 100.0, 0.01, 0.0, -1.0];
                let jump = jumps[(random.unit() * jumps.len() as f64) as usize];
                law.set_load(&mut state, T::of(base_n * jump));
            }
            let speed = |r: &mut Random| {
                T::of(if r.chance(0.1) {
                    0.0
                } else {
                    r.log_uniform(1e-9, 1e6)
                })
            };
            let u = [speed(&mut random), speed(&mut random), speed(&mut random)];
            let dt = T::of(random.log_uniform(1e-6, 10.0));
            law.advance_with(stepper, &mut state, u, T::ONE, dt);
            let eps = state.eps();
            assert!(
                eps >= T::ZERO && eps < T::ONE,
                "eps {eps:?} {law:?} {u:?} {dt:?}"
            );
            let sliding = law.friction(&state, u[2]);
            let f = sliding.along(T::ONE);
            assert!(f.is_finite(), "f {f:?} {law:?} {state:?} {u:?}");
            assert!(sliding.jump >= T::ZERO && sliding.smooth >= T::ZERO);
        }
        held += u32::from(state.clamped > 0);
    }
    // The test is meaningful only if many of these steps were too coarse.
    assert!(held > LAWS / 4, "{held} of {LAWS} laws were ever held");
}

#[test]
fn euler_in_double_precision_keeps_the_journal_inside_the_bearing() {
    torture::<f64>(&Euler, 1);
}

#[test]
fn euler_in_single_precision_keeps_the_journal_inside_the_bearing() {
    torture::<f32>(&Euler, 2);
}

#[test]
fn runge_kutta_in_double_precision_keeps_the_journal_inside_the_bearing() {
    torture::<f64>(&Rk4, 3);
}

#[test]
fn runge_kutta_in_single_precision_keeps_the_journal_inside_the_bearing() {
    torture::<f32>(&Rk4, 4);
}

/// Asserts that the journal stays inside the bearing in random steps as in [`torture`], with
/// inertia.
fn torture_full<T: Real>(stepper: &impl StiffStepper, seed: u64) {
    let mut random = Random::new(seed);
    for _ in 0..LAWS {
        let p = Parameters {
            f_m: T::of(random.log_uniform(1e-4, 10.0)),
            u_tr_m_s: T::of(random.log_uniform(1e-5, 1e2)),
            k0: T::of(random.log_uniform(1.0, 1e12)),
            gamma: T::of(random.log_uniform(1e-3, 1e5)),
        };
        let bearing = Bearing::THESIS.with_mass_kg(random.log_uniform(1e-3, 1e3));
        let base_n = random.log_uniform(1.0, 1e4);
        let law = JournalFull::new(&bearing, base_n, &p, Clock::Journal).expect("in the bounds");
        let mut state = law.start(T::of(base_n));
        for _ in 0..STEPS {
            if random.chance(0.05) {
                let jumps = [1.0, 100.0, 0.01, 0.0, -1.0];
                let jump = jumps[(random.unit() * jumps.len() as f64) as usize];
                law.set_load(&mut state, T::of(base_n * jump));
            }
            let u = [0; 3].map(|_| T::of(random.log_uniform(1e-9, 1e6)));
            let dt = T::of(random.log_uniform(1e-6, 10.0));
            law.advance_with(stepper, &mut state, u, T::ONE, dt);
            let eps = state.eps();
            assert!(
                eps >= T::ZERO && eps < T::ONE,
                "eps {eps:?} {law:?} {u:?} {dt:?}"
            );
            let f = law.friction(&state, u[2]).along(T::ONE);
            assert!(f.is_finite(), "f {f:?} {law:?} {state:?} {u:?}");
        }
    }
}

#[test]
fn full_model_keeps_the_journal_inside_the_bearing() {
    torture_full::<f64>(&Rodas3, 5);
    torture_full::<f32>(&Rodas3, 6);
    torture_full::<f64>(&Rodas5P, 7);
}

/// A step that is too coarse is counted once, and the film recovers from it.
#[test]
fn too_coarse_step_is_counted_and_the_film_recovers() {
    let law = common::law::<f64>(Clock::Journal);
    let mut state = law.start(104.0);
    law.advance_with(&Rk4, &mut state, [0.02; 3], 1.0, 0.002);
    assert_eq!(state.clamped, 0, "a loop step is not too coarse");
    law.advance_with(&Euler, &mut state, [1e3; 3], 1.0, 10.0);
    assert_eq!(state.clamped, 1);
    assert!(state.eps() < 1.0);
    for _ in 0..30_000 {
        law.advance(&mut state, [0.02; 3], 1.0, 0.002);
    }
    assert_eq!(state.clamped, 1);
    let steady = law.steady(0.02).expect("a speed");
    assert!(
        (state.eps() - steady.eps).abs() < 1e-9,
        "{} {}",
        state.eps(),
        steady.eps
    );
}

/// Input that is not finite leaves the film unchanged, and is counted.
#[test]
fn input_that_is_not_finite_leaves_the_film_unchanged() {
    let law = common::law::<f64>(Clock::Journal);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut state = law.start(104.0);
        let before = state.xy();
        law.advance(&mut state, [bad; 3], 1.0, 0.002);
        assert_eq!((state.xy(), state.clamped), (before, 1));
        law.advance(&mut state, [0.02; 3], 1.0, bad);
        assert_eq!((state.xy(), state.clamped), (before, 2));
    }
}

/// The film also recovers with asperities too soft to carry the load.
///
/// A step could otherwise be limited to the wall itself, where the film does not flow and the
/// journal would remain.
#[test]
fn film_recovers_with_asperities_too_soft_for_the_load() {
    for k0 in [1.0, 1e3, 1e5] {
        let p = Parameters {
            k0,
            ..Parameters::TABLE_4_2
        };
        let law = Journal::new(&Bearing::THESIS, 104.0, &p, Clock::Journal).expect("valid");
        let mut state = law.start(104.0);
        law.advance_with(&Euler, &mut state, [1e3; 3], 1.0, 10.0);
        assert_eq!(state.clamped, 1);
        for _ in 0..60_000 {
            law.advance(&mut state, [0.05; 3], 1.0, 0.002);
        }
        let steady = law.steady(0.05).expect("a speed");
        assert!(
            (state.eps() - steady.eps).abs() < 1e-6,
            "{k0}: {}",
            state.eps()
        );
    }
}
