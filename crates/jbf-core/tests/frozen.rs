//! Tests of control loops whose encoder freezes for three seconds and recovers, for friction models
//! with any viscous friction.
//!
//! The speed stays within the ability of the drive. One second after the recovery, the tracking
//! error is that before the fault. A position loop first returns from the angle to which it
//! drifted.

mod common;

use common::bench::{self, Control, COUNTS_PER_RAD, DRIVE, DT_S, LOAD_N};
use common::chain_round;
use jbf_core::compensator::{ChainModel, FrictionModel};
use jbf_core::compensator::{LawModel, Observed};
use jbf_core::controller::Status;
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::dahl::Dahl;
use jbf_core::law::{Law, Named};
use jbf_core::plant::Plant;
use jbf_core::reference::Target;
use jbf_core::{Chain, Clock, Real};

/// Number of steps before the encoder freezes.
///
/// `FROZEN` is the number of steps while it is frozen. `SEEN` is the number of steps in which errors
/// are compared, one period of the target.
const RUN: u32 = 2000;
const FROZEN: u32 = 1500;
const SEEN: u32 = 1000;

/// Twice the speed that the largest voltage of the drive sustains without friction, rad/s.
const FASTEST_RAD_S: f64 = 68.0;

/// Permitted tracking error due to values learned during the fault, relative to the amplitude of
/// the target.
const ALLOWED: f64 = 0.15;

const NO_EFFECTS: &[(&str, &[f64])] = &[];

fn law<T: Real, L: Named<T>>(values: &[f64]) -> L {
    let lifted: Vec<T> = values.iter().map(|&v| T::of(v)).collect();
    L::build(None, None, &lifted, Clock::Journal).expect("in the bounds")
}

/// Runs a loop with a friction model on a shaft with friction, and returns its tracking errors.
///
/// They are the RMS of the error measured by the loop, relative to the amplitude of the target,
/// over the last period before the fault and over one period after it.
fn errors<T: Real, L: Law<f64>>(
    told: &str,
    control: Control,
    chain: Chain<f64, L>,
    model: impl FrictionModel<T>,
) -> [f64; 2] {
    let compensator = Observed::new(model, &bench::settings(control)).expect("settings");
    let controller = bench::controller::<T, _>(control, compensator);
    // An amplitude within the ability of the drive.
    let viscous_v = chain.law.friction(&chain.law.start(LOAD_N), 0.0127).smooth * DRIVE.volts_per_n;
    let size = 1.5 / (1.0 + 1.5 * viscous_v);
    let plant = Plant::new(chain, DRIVE, DT_S / 2.0).expect("the thesis's drive");
    let (mut shaft, mut state) = (plant.start(LOAD_N, 0.1), controller.start());
    let (mut counter, mut squares) = (0, [0.0_f64; 2]);
    let back = match control {
        Control::Velocity => 500,
        Control::Position => 2500,
    };
    let lives = RUN + FROZEN;
    for i in 0..lives + back + SEEN {
        let frozen = (RUN..lives).contains(&i);
        if !frozen {
            counter = ((shaft.angle_rad * COUNTS_PER_RAD).floor() as i64) as u32 & 0xffff;
        }
        let rate = core::f64::consts::TAU / (f64::from(SEEN) * DT_S);
        let phase = rate * f64::from(i) * DT_S;
        let target = Target {
            value: T::of(size * phase.sin()),
            rate: T::of(rate * size * phase.cos()),
        };
        let parts = controller.step(&mut state, counter, &target);
        let speed = parts.velocity_rad_s.value();
        assert!(
            speed.abs() < FASTEST_RAD_S,
            "{told}: {speed} rad/s at step {i}"
        );
        for _ in 0..2 {
            plant.step(&mut shaft, parts.output_v.value(), LOAD_N);
        }
        let error = parts.error.value().powi(2);
        if (RUN - SEEN..RUN).contains(&i) {
            squares[0] += error / f64::from(SEEN);
        } else if i >= lives + back {
            squares[1] += error / f64::from(SEEN);
            assert!(!parts.status.has(Status::FROZEN), "{told}: step {i}");
        }
    }
    squares.map(|square| square.sqrt() / size)
}

/// Asserts that the tracking error recovers after the fault in a position and in a velocity loop.
///
/// The compensator uses the law with its effects. A law without effects is also tested in the
/// compensator for a law alone.
fn comes_back<T: Real, A: Named<T>, B: Named<f64>>(values: &[f64], effects: &[(&str, &[f64])]) {
    for (control, named) in [
        (Control::Position, "position"),
        (Control::Velocity, "velocity"),
    ] {
        let chain = || chain_round(law::<f64, B>(values), effects);
        let whole = ChainModel::new(
            chain_round(law::<T, A>(values), effects),
            DRIVE.volts_per_n,
            LOAD_N,
        );
        let bare = LawModel::new(law::<T, A>(values), 0.0127, DRIVE.volts_per_n, LOAD_N);
        let told = format!("{} {values:?} {effects:?} {named}", A::INFO.name);
        let mut seen = vec![errors(&told, control, chain(), whole)];
        if effects.is_empty() {
            seen.push(errors(&told, control, chain(), bare));
        }
        for [before, after] in seen {
            assert!(
                after < 1.5 * before + ALLOWED,
                "{told}: {before} before, {after} after"
            );
        }
    }
}

#[test]
fn loop_recovers_from_a_frozen_encoder_with_any_viscous_friction_in_double_precision() {
    for viscous in [0.0, 100.0, 1e3, 2e3, 3e3, 5e3, 1e4, 2e4, 5e4, 1e5, 1e6, 1e7] {
        comes_back::<f64, Coulomb<f64>, Coulomb<f64>>(&[8.0, 10.0, viscous], NO_EFFECTS);
    }
}

#[test]
fn loop_recovers_from_a_frozen_encoder_with_any_viscous_friction_in_single_precision() {
    for viscous in [0.0, 100.0, 1e3, 2e3, 3e3, 5e3, 1e4, 2e4, 5e4, 1e5, 1e6, 1e7] {
        comes_back::<f32, Coulomb<f32>, Coulomb<f64>>(&[8.0, 10.0, viscous], NO_EFFECTS);
    }
}

/// A loop recovers with steep viscous friction from effects: a weight that conceals it, an
/// asymmetry that doubles it, a quadratic drag, and a bristle.
#[test]
fn loop_recovers_from_a_frozen_encoder_with_steep_friction_from_effects() {
    let values = [8.0, 10.0, 1e4];
    for effect in [
        ("gravity", &[20.0, 0.3][..]),
        ("viscous_asymmetry", &[5e3][..]),
        ("quadratic_drag", &[1e6][..]),
        ("presliding", &[5e4][..]),
        ("drive_compliance", &[600.0, 0.1, 2e-3][..]),
    ] {
        comes_back::<f32, Coulomb<f32>, Coulomb<f64>>(&values, &[effect]);
    }
    comes_back::<f32, Dahl<f32>, Dahl<f64>>(&[8.0, 1e6, 1.0, 2e4], NO_EFFECTS);
}
