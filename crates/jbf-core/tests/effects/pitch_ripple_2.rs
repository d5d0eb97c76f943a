//! Tests that a second ripple multiplies the friction with the first.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};
use core::f64::consts::TAU;

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn second_ripple_multiplies_the_friction_with_the_first() {
    let sines = Sines::two_way(1.0);
    let pair: [(&str, &[f64]); 2] = [
        ("pitch_ripple", &[0.2, 0.02, 0.4]),
        ("pitch_ripple_2", &[0.1, 0.01, -1.3]),
    ];
    let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &pair);
    let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
    for (i, f) in got.iter().enumerate().skip(1) {
        let t = 0.01 * i as f64;
        let (v, way) = (0.127 * t.sin(), 0.127 * (1.0 - t.cos()));
        let first = 1.0 + 0.2 * (TAU * way / 0.02 - 0.4).cos();
        let second = 1.0 + 0.1 * (TAU * way / 0.01 + 1.3).cos();
        let expected = (F_C_N * v.signum() + F_V_N_S_M * v) * first * second;
        assert!((f - expected).abs() < 1e-9, "{i}: {f} {expected}");
    }
}
