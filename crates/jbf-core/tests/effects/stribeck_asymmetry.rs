//! Tests of `+ c exp(-(|v|/v_s)^n)`: the friction of the two directions differs at low speed only.

use crate::common::motion::{held, Sines};
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn peak_is_raised_in_one_direction_and_lowered_in_the_other() {
    let sines = Sines::two_way(1.0);
    for (c, v_s, n) in [(2.0, 0.03, 1.0), (-1.0, 0.01, 2.0), (0.5, 0.1, 0.5)] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("stribeck_asymmetry", &[c, v_s, n])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let v = 0.127 * (0.01 * i as f64).sin();
            let plain = F_C_N * v.signum() + F_V_N_S_M * v;
            let expected = plain + c * (-((v.abs() / v_s).powf(n))).exp();
            assert!((f - expected).abs() < 1e-12, "{c} {i}: {f} {expected}");
        }
    }
}

/// Friction in the direction with the lower peak is zero, not negative, if the peak exceeds the dry
/// friction.
#[test]
fn friction_never_drives_if_the_peak_exceeds_the_level() {
    let sines = Sines::two_way(1.0);
    let chain = chain_round(
        newtons(F_C_N, 0.0),
        &[("stribeck_asymmetry", &[9.0, 10.0, 1.0])],
    );
    let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
    let back = |i: usize| (0.01 * i as f64).sin() < 0.0;
    assert!((1..got.len()).filter(|&i| back(i)).all(|i| got[i] == 0.0));
}

/// The friction level at rest is unchanged, because both directions are possible.
#[test]
fn holding_level_at_rest_is_unchanged() {
    let chain = chain_round(
        newtons(F_C_N, 0.0),
        &[("stribeck_asymmetry", &[2.0, 0.03, 1.0])],
    );
    let state = chain.start(&held::<f64>(0.4, 0.0));
    assert_eq!(chain.reaction_n(&state).jump, F_C_N);
    assert_eq!(state.reading_n, 0.0);
}
