//! Tests of encoder, velocity observer, Coulomb observer and reference against the equations of
//! Cohn (1998).

mod common;

use common::bench::{COUNTS_PER_RAD, DT_S};
use jbf_core::encoder::{self, Encoder};
use jbf_core::observer::coulomb::State;
use jbf_core::observer::{CoulombObserver, VelocityObserver};
use jbf_core::reference::{Reference, Wave};

#[test]
fn counter_overflow_is_followed_in_both_directions() {
    let encoder = Encoder::<f64>::new(COUNTS_PER_RAD, 16, 68.0, DT_S).unwrap();
    let mut state = encoder::State::default();
    let mut true_counts = 0_i64;
    for i in 0..400_000_i64 {
        let there = if i < 200_000 { 150 } else { -170 };
        true_counts += there;
        let sample = encoder.step(&mut state, (true_counts as u32) & 0xffff);
        assert!(!sample.jumped);
    }
    let moved = (true_counts - 150) as f64 / COUNTS_PER_RAD;
    assert!((encoder.angle_rad(&state) - moved).abs() < 1e-9);
}

#[test]
fn jump_of_the_counter_is_reported_and_ignored() {
    let encoder = Encoder::<f64>::new(COUNTS_PER_RAD, 16, 68.0, DT_S).unwrap();
    let mut state = encoder::State::default();
    encoder.step(&mut state, 100);
    let sample = encoder.step(&mut state, 5100);
    assert!(sample.jumped);
    assert_eq!(sample.moved_rad, 0.0);
    let sample = encoder.step(&mut state, 5103);
    assert!(!sample.jumped);
    assert!((sample.moved_rad - 3.0 / COUNTS_PER_RAD).abs() < 1e-12);
    for n in 1..=5 {
        assert_eq!(encoder.step(&mut state, 5103).still, n);
    }
}

#[test]
fn top_speed_at_which_a_counter_overflow_is_ambiguous_is_refused() {
    let error = Encoder::<f64>::new(COUNTS_PER_RAD, 8, 68.0, DT_S).unwrap_err();
    assert_eq!(error.name(), "top_speed_rad_s");
}

/// Single precision resolves a single count after a billion counts.
#[test]
fn angle_of_a_billion_counts_is_exact() {
    let encoder = Encoder::<f64>::new(1.0, 32, 1e9, DT_S).unwrap();
    let mut state = encoder::State::default();
    encoder.step(&mut state, 0);
    let mut counter = 0_u32;
    for _ in 0..1000 {
        counter = counter.wrapping_add(1_000_001);
        encoder.step(&mut state, counter);
    }
    assert_eq!(encoder.angle_rad(&state), 1_000_001_000.0);
}

/// The velocity observer equals the step in Cohn (1998), `v = k x + z; z += dt (-(a + k) v + b u)`.
#[test]
fn velocity_observer_equals_that_of_the_thesis() {
    for (a, b) in [(0.0, 0.0), (135.0, 457.0)] {
        let ours = VelocityObserver::<f64>::with_feedforward(15.0, a, b, DT_S).unwrap();
        let (mut z, mut carried, mut before) = (0.0, 0.0, 0.0);
        for i in 0..5000_u32 {
            let t = f64::from(i) * DT_S;
            let (x, u) = ((0.7 * t).sin() * 3.0, (1.3 * t).cos());
            let theirs = 15.0 * x + z;
            let v = ours.correct(carried, x - before);
            assert!((v - theirs).abs() < 1e-9, "{t}");
            z += DT_S * (-(15.0 + a) * theirs + b * u);
            carried = ours.predict(v, u);
            before = x;
        }
    }
}

/// With a constant friction F, the estimated level converges to F at the rate k_F b (p = 1).
#[test]
fn coulomb_observer_converges_at_its_rate() {
    let (gain, b, friction) = (0.01, 457.0, 0.7);
    let observer = CoulombObserver::<f64>::new(gain, 1.0, b, 5.0, DT_S).unwrap();
    let mut state = State::default();
    let mut v = 50.0;
    for i in 0..1000_u32 {
        let level = observer.level_v(&state, &observer.power(v));
        let t = f64::from(i) * DT_S;
        // It begins at -k_F v, and each Euler step covers the share k_F b dt of the remaining
        // difference.
        let exact = friction + (-gain * 50.0 - friction) * (1.0 - gain * b * DT_S).powi(i as i32);
        assert!((level - exact).abs() < 1e-9, "{t}: {level} {exact}");
        observer.learn(&mut state, &observer.power(v), v, 0.0);
        v += DT_S * b * (level - friction);
        if v < 10.0 {
            // Keep it moving with an input that is known to the observer.
            observer.learn(&mut state, &observer.power(v), v, (50.0 - v) / DT_S);
            v = 50.0;
        }
    }
}

/// The function phi is continuous, its derivative is correct, and the gain of the observer is
/// bounded.
///
/// Exponents above and below 1 are tested: phi becomes its tangent near v = 0 for p < 1, and at
/// high speed for p > 1.
#[test]
fn guarded_nonlinearity_has_bounded_gain_and_correct_derivative() {
    let (gain, b) = (0.01, 457.0);
    for exponent in [0.3, 0.5, 0.9, 1.0, 1.5, 2.0, 3.0] {
        let observer = CoulombObserver::<f64>::new(gain, exponent, b, 1e6, DT_S).unwrap();
        let mut state = State::default();
        let mut before: Option<(f64, f64)> = None;
        for i in 0..60_000_u32 {
            let w = 1e-6 * 1.0003_f64.powi(i as i32);
            let level = -observer.level_v(&State::default(), &observer.power(w)) / gain;
            // The derivative, from the change learned in one step.
            state = State::default();
            observer.learn(&mut state, &observer.power(w), w, 1.0);
            let learned = observer.level_v(&state, &observer.power(w)) + gain * level;
            let slope = learned / (DT_S * gain);
            assert!(slope.is_finite() && slope * gain * b * DT_S <= 0.5 + 1e-9 || exponent == 1.0);
            if let Some((w0, level0)) = before {
                let rise = (level - level0) / (w - w0);
                let near = (rise - slope).abs() <= 2e-3 * slope.abs() + 1e-6;
                assert!(near, "p {exponent}, w {w}: {rise} {slope}");
            }
            before = Some((w, level));
        }
        // At exactly zero speed the level is held.
        let rest = state;
        let mut held = state;
        observer.learn(&mut held, &observer.power(0.0), 0.0, 1e3);
        let at = observer.power(0.0);
        assert_eq!(observer.level_v(&held, &at), observer.level_v(&rest, &at));
    }
}

/// A gain is refused if phi would be its tangent at every speed of a shaft, as for an exponent just
/// below one.
///
/// The tangent used to overflow, so that phi was not finite.
#[test]
fn observer_gain_whose_guard_exceeds_every_speed_is_refused() {
    let error = CoulombObserver::<f32>::new(14.4, 0.991, 5.0, 0.3, 0.025).unwrap_err();
    assert_eq!(error.name(), "gain");
    assert!(CoulombObserver::<f32>::new(0.01, 0.991, 5.0, 0.3, 0.025).is_ok());
}

#[test]
fn learned_level_stays_at_its_limit_if_friction_exceeds_it() {
    let observer = CoulombObserver::<f32>::new(0.01, 1.0, 457.0, 2.0, DT_S).unwrap();
    let mut state = State::default();
    for _ in 0..100_000 {
        let power = observer.power(1.0);
        observer.learn(&mut state, &power, 1.0, 1e6);
    }
    assert!((observer.level_v(&state, &observer.power(1.0)) - 2.0).abs() < 1e-5);
}

/// References start with the phases of Appendices D and E of Cohn (1998).
///
/// A sine that crosses zero starts at zero, any other at its minimum. A triangle wave starts at its
/// minimum, and a square wave at its maximum.
#[test]
fn references_start_with_the_phases_of_the_thesis() {
    let at = |wave, low, high| Reference::new(wave, low, high, 0.25).unwrap().at(0.0);
    assert!(at(Wave::Sine, -1.04, 1.04).value.abs() < 1e-12);
    assert!(at(Wave::Sine, -1.04, 1.04).rate > 0.0);
    assert!((at(Wave::Sine, 0.52, 20.8).value - 0.52).abs() < 1e-12);
    assert!((at(Wave::Triangle, 0.0, 10.4).value).abs() < 1e-12);
    assert_eq!(at(Wave::Square, -1.04, 1.04).value, 1.04);
}

/// Rates are the derivatives of the values, except at corners.
#[test]
fn reference_rates_are_the_derivatives_of_the_values() {
    for wave in [Wave::Sine, Wave::Triangle] {
        let reference = Reference::new(wave, -1.0, 3.0, 0.5).unwrap();
        for i in 0..1000_u32 {
            let t = 0.0371 + f64::from(i) * 0.05;
            let h = 1e-6;
            let slope = (reference.at(t + h).value - reference.at(t - h).value) / (2.0 * h);
            assert!((slope - reference.at(t).rate).abs() < 1e-6, "{wave:?} {t}");
        }
    }
}
