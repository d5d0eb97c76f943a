//! Tests that dry friction is multiplied by `1 + a sgn v`, while viscous friction does not depend
//! on the direction.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};
use jbf_core::law::stribeck::Stribeck;
use jbf_core::law::Named;
use jbf_core::Clock;

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn dry_level_differs_by_direction_but_the_viscous_slope_does_not() {
    let sines = Sines::two_way(1.0);
    for a in [0.3, -0.8] {
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &[("dry_asymmetry", &[a])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let v = 0.127 * (0.01 * i as f64).sin();
            let level = F_C_N * if v > 0.0 { 1.0 + a } else { 1.0 - a };
            let expected = level * v.signum() + F_V_N_S_M * v;
            assert!((f - expected).abs() < 1e-12, "{a} {i}: {f} {expected}");
        }
    }
}

/// The effect equals a constant force in motion, and is zero at rest.
#[test]
fn effect_equals_a_constant_force_in_motion_and_is_zero_at_rest() {
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let pair: [(&str, &[f64]); 2] = [("dry_asymmetry", &[0.3]), ("sensor_offset", &[0.3 * F_C_N])];
    let [one, other] = pair.map(|effect| {
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &[effect]);
        readings(&chain, 0.01, 700, |t| sines.at::<f64>(t))
    });
    let rests = |i: usize| (300..400).contains(&i);
    for (i, (a, b)) in one.iter().zip(&other).enumerate().skip(1) {
        let apart = if rests(i) { 0.3 * F_C_N } else { 0.0 };
        assert!((b - a - apart).abs() < 1e-12, "{i}: {a} {b}");
    }
}

/// The Stribeck peak is dry friction and is scaled by the same factor.
#[test]
fn stribeck_peak_is_scaled_like_the_dry_level() {
    let values = [6.0, 10.0, 0.03, 1.0, 0.0];
    let law = || Stribeck::build(None, None, &values, Clock::Journal).expect("a sound law");
    let sines = Sines::two_way(1.0);
    let run = |effects: &[(&str, &[f64])]| {
        readings(&chain_round(law(), effects), 0.01, 700, |t| {
            sines.at::<f64>(t)
        })
    };
    let (plain, with) = (run(&[]), run(&[("dry_asymmetry", &[0.25])]));
    for (a, b) in plain.iter().zip(&with).skip(1) {
        let factor = if *a > 0.0 { 1.25 } else { 0.75 };
        assert!((b - factor * a).abs() < 1e-12, "{a} {b}");
    }
}
