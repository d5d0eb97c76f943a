//! Tests that compensation reduces the tracking error, with a correct friction model and with a
//! model that lacks an effect.
//!
//! The error does not change over 1e8 steps.

#[macro_use]
mod common;

use common::bench::{controller, observed, observed_with, plant, Bench, Control, DT_S};
use jbf_core::compensator::{Compensator, NoCompensation};
use jbf_core::controller::Controller;
use jbf_core::reference::{Reference, Wave};
use jbf_core::Real;

fn rms<T: Real, C: Compensator<T>>(
    controller: Controller<T, C>,
    effects: &[(&str, &[f64])],
    control: Control,
) -> f64 {
    let mut bench = Bench::new(plant(effects), controller);
    let reference = Reference::new(Wave::Sine, -1.04, 1.04, 0.5).unwrap();
    let (mut sum, mut n) = (0.0, 0.0);
    for i in 0..15_000_u32 {
        let target = reference.at(f64::from(i) * DT_S);
        let there = match control {
            Control::Position => bench.shaft.angle_rad,
            Control::Velocity => bench.shaft.speed_rad_s,
        };
        bench.step(target.value, target.rate);
        if i > 1_000 {
            sum += (there - target.value).powi(2);
            n += 1.0;
        }
    }
    (sum / n).sqrt()
}

#[test]
fn observed_compensator_halves_the_error_of_the_other_schemes() {
    for control in [Control::Position, Control::Velocity] {
        let mut others = Vec::new();
        let mut ours = f64::INFINITY;
        with_each_compensator!(f64, control, |name, c| {
            let error = rms(c, &[("presliding", &[5e4])], control);
            if name == "observed" {
                ours = error;
            } else if name == "none" || name == "coulomb" || name == "learning" {
                others.push((name, error));
            }
        });
        for (name, error) in others {
            assert!(ours < 0.5 * error, "{name}: {error}, ours {ours}");
        }
    }
}

/// A compensator whose model has the effect of the plant tracks better than one without the effect.
#[test]
fn compensator_with_the_effect_of_the_plant_has_a_smaller_error() {
    let control = Control::Velocity;
    for effect in [
        ("presliding", &[2e4][..]),
        // Moderate: a steep one makes any loop of this bandwidth stick and slip.
        ("stribeck_excess", &[0.03, 0.01, 1.0][..]),
        ("direction_asymmetry", &[0.3][..]),
        ("position_ripple", &[0.3, 0.5][..]),
    ] {
        let hidden = [effect];
        let bare = rms(
            controller(control, observed::<f64>(control)),
            &hidden,
            control,
        );
        let told = controller(control, observed_with::<f64>(control, &hidden));
        let told = rms(told, &hidden, control);
        assert!(told < 0.97 * bare, "{}: {told} against {bare}", effect.0);
    }
}

/// The error of the observer decays with its poles: two at -60 1/s, and that of the plant at -135
/// 1/s.
#[test]
fn observer_error_decays_at_the_rate_of_the_requested_poles() {
    let control = Control::Velocity;
    let compensator = observed::<f64>(control);
    let mut state = compensator.start();
    // A shaft at 5 rad/s under the voltage that holds this speed, with the friction of the model.
    let mut log = Vec::new();
    for i in 0..400 {
        let volts = 135.0 / 457.0 * 5.0 + 0.05;
        let v = compensator.observe(&mut state, 0.0, 5.0 * DT_S, volts, false);
        if i > 60 {
            log.push((v - 5.0).abs());
        }
    }
    // After the fast pole has decayed, the double pole remains: |error| ~ (c0 + c1 n) p^n.
    let (n0, n1) = (40, 90);
    let rate = (log[n0] / log[n1]).ln() / ((n1 - n0) as f64 * DT_S);
    assert!((40.0..62.0).contains(&rate), "{rate} 1/s");
}

fn endless<T: Real, C: Compensator<T>>(name: &str, control: Control, c: Controller<T, C>, n: u64) {
    let mut bench = Bench::new(plant(&[]), c);
    let lap = 1000_u64;
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for i in 0..n {
        let phase = (i % lap) as f64 / lap as f64 * core::f64::consts::TAU;
        let rate = core::f64::consts::TAU / (lap as f64 * DT_S);
        // With an offset, so that the shaft turns continuously and the counter rolls over.
        let (value, slope) = match control {
            Control::Velocity => (2.0 + 3.0 * phase.sin(), 3.0 * rate * phase.cos()),
            Control::Position => (phase.sin(), rate * phase.cos()),
        };
        let there = match control {
            Control::Position => bench.shaft.angle_rad,
            Control::Velocity => bench.shaft.speed_rad_s,
        };
        bench.step(value, slope);
        let square = (there - value).powi(2);
        if (lap * 20..lap * 40).contains(&i) {
            early += square;
        }
        if i >= n - lap * 20 {
            late += square;
        }
    }
    let (early, late) = (early.sqrt(), late.sqrt());
    assert!(
        late.is_finite() && late < 1.3 * early + 0.5,
        "{name}: {early} then {late}"
    );
}

/// The tracking error does not change over 300,000 steps in single precision.
#[test]
fn tracking_error_does_not_change_over_300_000_steps() {
    for control in [Control::Velocity, Control::Position] {
        with_each_compensator!(f32, control, |name, c| {
            endless(name, control, c, 300_000)
        });
    }
}

/// The tracking error does not change over 1e8 steps, 55 hours of the loop: `cargo test --release
/// -- --ignored`.
#[test]
#[ignore = "minutes: make test-extended"]
fn tracking_error_does_not_change_over_a_hundred_million_steps() {
    let n = 100_000_000;
    let control = Control::Velocity;
    endless(
        "observed f32",
        control,
        controller(control, observed::<f32>(control)),
        n,
    );
    let coulomb = controller(control, common::bench::coulomb::<f32>());
    endless("coulomb f32", control, coulomb, n);
    let learning = controller(control, common::bench::learning::<f32>(control));
    endless("learning f32", control, learning, n);
    let none = controller::<f32, _>(control, NoCompensation);
    endless("none f32", control, none, n);
}
