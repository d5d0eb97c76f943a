//! Tests of cogging: a force `A sin(2 pi x/p - phi)` in motion and at rest, which is not friction.

use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings};
use core::f64::consts::TAU;
use jbf_core::{Bearing, Motion};

const F_C_N: f64 = 6.0;

#[test]
fn force_is_periodic_in_the_position_with_the_pitch() {
    let sines = Sines::two_way(1.0);
    for (a, pitch, phi) in [(0.7, 0.011, 0.4), (3.0, 0.2, -2.0)] {
        let chain = chain_round(newtons(F_C_N, 0.0), &[("cogging", &[a, pitch, phi])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let way = 0.127 * (1.0 - t.cos());
            let expected = F_C_N * t.sin().signum() + a * (TAU * way / pitch - phi).sin();
            assert!((f - expected).abs() < 1e-9, "{a} {i}: {f} {expected}");
        }
    }
}

/// The force acts on a drive at rest; the friction level that holds the drive does not change.
#[test]
fn force_acts_at_rest_without_changing_the_holding_level() {
    let chain = chain_round(newtons(F_C_N, 0.0), &[("cogging", &[2.0, 0.01, 0.5])]);
    let held = |t: f64| Motion {
        angle_rad: 1.1,
        ..constant::<f64>(0.0, t)
    };
    let expected = 2.0 * (TAU * 1.1 * Bearing::THESIS.radius_m / 0.01 - 0.5).sin();
    for r in readings(&chain, 0.01, 5, held) {
        assert!((r - expected).abs() < 1e-12);
    }
    let felt = chain.reaction_n(&chain.start(&held(0.0)));
    assert_eq!(felt.jump, F_C_N);
}

/// The work of the force over whole pitches is zero.
#[test]
fn work_over_whole_pitches_is_zero() {
    let (pitch, speed) = (0.01, 0.02);
    let chain = chain_round(newtons(F_C_N, 0.0), &[("cogging", &[2.0, pitch, 0.5])]);
    let steps = 2000;
    let dt = 4.0 * pitch / speed / f64::from(steps);
    let got = readings(&chain, dt, steps, |t| constant::<f64>(speed, t));
    let mean = got[1..].iter().sum::<f64>() / f64::from(steps);
    assert!((mean - F_C_N).abs() < 1e-9, "{mean}");
}

/// Single precision resolves the position within a pitch far from position zero.
#[test]
fn force_in_single_precision_agrees_with_double_far_from_zero() {
    use crate::common::chain;
    let effects: [(&str, &[f64]); 1] = [("cogging", &[2.0, 0.01, 0.5])];
    let sines = Sines::two_way(1.0);
    let double = readings(&chain::<f64>(&effects), 0.01, 300, |t| sines.at(t));
    let single = readings(&chain::<f32>(&effects), 0.01, 300, |t| sines.at(t));
    for (a, b) in double.iter().zip(&single) {
        assert!((a - f64::from(*b)).abs() < 1e-3);
    }
}

/// A gear does not transmit the cogging force of its motor, so its load-dependent friction does not
/// change.
#[test]
fn cogging_force_does_not_change_the_load_dependent_friction_of_a_gear() {
    let gear: (&str, &[f64]) = ("torque_proportional", &[0.5]);
    let teeth: (&str, &[f64]) = ("cogging", &[2.0, 0.01, 0.5]);
    let sines = Sines::two_way(1.0);
    let [with, without] = [vec![gear, teeth], vec![teeth]].map(|effects| {
        readings(
            &chain_round(newtons(F_C_N, 0.0), &effects),
            0.01,
            300,
            |t| sines.at::<f64>(t),
        )
    });
    assert_eq!(with, without);
}
