//! Tests that the learned values of compensators can be stored and resumed: `cargo test -p jbf-core
//! --features serde`.
#![cfg(feature = "serde")]

mod common;

use common::bench::{
    controller, coulomb, learning, observed, plant, repetitive, Bench, Control, DT_S,
};
use jbf_core::compensator::learning::Learned as Film;
use jbf_core::compensator::observed::Learned as Corrections;
use jbf_core::compensator::{Compensator, Input};
use jbf_core::controller::Status;
use jbf_core::encoder::{Encoder, State as Counter};
use serde::de::DeserializeOwned;
use serde::Serialize;

const CONTROL: Control = Control::Velocity;

fn stored<S: Serialize + DeserializeOwned>(state: &S) -> S {
    let text = serde_json::to_string(state).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// Runs a loop for some periods of two seconds and returns the state of its compensator.
fn driven<C: Compensator<f64>>(compensator: C) -> C::State {
    let mut bench = Bench::new(plant(&[]), controller(CONTROL, compensator));
    for i in 0..20_000_u32 {
        let phase = core::f64::consts::PI * f64::from(i) * DT_S;
        bench.step(2.0 + phase.sin(), 0.0);
    }
    bench.state.compensator
}

/// Asserts that two states of a compensator result in the same output over 5000 steps.
fn go_on_alike<C: Compensator<f64>>(compensator: &C, mut one: C::State, mut other: C::State) {
    for i in 0..5_000_u32 {
        let t = f64::from(i) * DT_S;
        let input = Input {
            angle_rad: t.cos(),
            velocity_rad_s: -t.sin(),
            error: 0.1 * (3.0 * t).sin(),
            reference_rad_s: -t.sin(),
            reference_rad_s2: -t.cos(),
            base_v: 0.5 * (2.0 * t).cos(),
            may_learn: true,
        };
        let answers = [
            compensator.step(&mut one, &input),
            compensator.step(&mut other, &input),
        ];
        assert_eq!(answers[0], answers[1], "step {i}");
    }
}

#[test]
fn stored_learning_compensator_resumes_its_values() {
    let state = driven(learning(CONTROL));
    let kept: Film<f64> = stored(&state.learned);
    assert_eq!(kept, state.learned);
    let fresh = learning::<f64>(CONTROL).start().learned;
    assert_ne!(kept, fresh);
    assert_eq!(learning(CONTROL).resumed(kept).start().learned, kept);
}

#[test]
fn stored_coulomb_observer_continues_unchanged() {
    let state = driven(coulomb());
    let kept = stored(&state);
    assert_eq!(kept, state);
    assert_ne!(kept, coulomb().start());
    go_on_alike(&coulomb(), state, kept);
}

#[test]
fn stored_corrections_of_the_observed_model_are_resumed() {
    let state = driven(observed(CONTROL));
    let kept: Corrections<f64> = stored(&state.learned);
    assert_eq!(kept, state.learned);
    assert_ne!(kept, Corrections::default());
    let again = observed::<f64>(CONTROL).resumed(kept);
    assert_eq!(again.start().learned, kept);
}

#[test]
fn stored_period_of_the_repetitive_compensator_continues_unchanged() {
    let state = driven(repetitive());
    go_on_alike(&repetitive(), state, stored(&state));
}

#[test]
fn stored_single_precision_values_keep_their_bits() {
    let learned = Film {
        k0: 650_000.1_f32,
        gamma: 33.3,
    };
    assert_eq!(stored(&learned), learned);
    let status = Status::FROZEN | Status::FALLBACK;
    assert_eq!(stored(&status), status);
}

#[test]
fn stored_encoder_counter_continues_at_its_angle() {
    let encoder: Encoder<f64> = Encoder::new(2387.3, 16, 68.0, DT_S).unwrap();
    let mut here = Counter::default();
    for i in 0..10_000_u32 {
        encoder.step(&mut here, (i * 100) & 0xffff);
    }
    let mut there = stored(&here);
    assert_eq!(
        encoder.step(&mut here, 7).moved_rad,
        encoder.step(&mut there, 7).moved_rad
    );
    assert_eq!(encoder.angle_rad(&here), encoder.angle_rad(&there));
}
