//! Tests that friction is multiplied by `1 + a cos(2 pi x/p - phi)`, both dry and viscous.

use crate::common::motion::{held, Sines};
use crate::common::{chain_round, newtons, readings};
use core::f64::consts::TAU;
use jbf_core::Bearing;

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn friction_is_scaled_by_the_position_within_a_pitch() {
    let sines = Sines::two_way(1.0);
    for (a, pitch, phi) in [(0.1, 0.011, 0.4), (0.9, 0.2, -2.0)] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("pitch_ripple", &[a, pitch, phi])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let (v, way) = (0.127 * t.sin(), 0.127 * (1.0 - t.cos()));
            let plain = F_C_N * v.signum() + F_V_N_S_M * v;
            let expected = plain * (1.0 + a * (TAU * way / pitch - phi).cos());
            assert!((f - expected).abs() < 1e-9, "{a} {i}: {f} {expected}");
        }
    }
}

/// With a pitch of one turn the effect equals `position_ripple`.
#[test]
fn pitch_of_one_turn_equals_the_position_ripple() {
    let turn = TAU * Bearing::THESIS.radius_m;
    let sines = Sines::two_way(1.0);
    let pair: [(&str, &[f64]); 2] = [
        ("pitch_ripple", &[0.3, turn, 0.7]),
        ("position_ripple", &[0.3, 0.7]),
    ];
    let [one, other] = pair.map(|effect| {
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &[effect]);
        readings(&chain, 0.01, 700, |t| sines.at::<f64>(t))
    });
    for (a, b) in one.iter().zip(&other) {
        assert!((a - b).abs() < 1e-12);
    }
}

/// The reading of a rigid drive at rest is zero; the friction level that holds the drive varies
/// with the position.
#[test]
fn holding_level_varies_with_the_position_but_the_reading_at_rest_is_zero() {
    let chain = chain_round(newtons(F_C_N, 0.0), &[("pitch_ripple", &[0.5, 0.01, 0.0])]);
    let state = chain.start(&held::<f64>(1.1, 0.0));
    let factor = 1.0 + 0.5 * (TAU * 1.1 * Bearing::THESIS.radius_m / 0.01).cos();
    assert!((chain.reaction_n(&state).jump - F_C_N * factor).abs() < 1e-12);
    assert_eq!(state.reading_n, 0.0);
}
