//! Tests that a second periodic force is added to the first, in motion and at rest.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};
use core::f64::consts::TAU;

const F_C_N: f64 = 6.0;

#[test]
fn second_cogging_force_is_added_to_the_first() {
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let pair: [(&str, &[f64]); 2] = [
        ("cogging", &[1.5, 0.02, 0.4]),
        ("cogging_2", &[0.5, 0.01, -1.3]),
    ];
    let chain = chain_round(newtons(F_C_N, 0.0), &pair);
    let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
    for (i, f) in got.iter().enumerate().skip(1) {
        let at = 0.01 * i as f64;
        let rests = (300..400).contains(&i);
        let t = if i < 300 { at } else { (at - 1.0).max(3.0) };
        let (v, way) = (0.127 * t.sin(), 0.127 * (1.0 - t.cos()));
        let level = if rests { 0.0 } else { F_C_N * v.signum() };
        let first = 1.5 * (TAU * way / 0.02 - 0.4).sin();
        let second = 0.5 * (TAU * way / 0.01 + 1.3).sin();
        let expected = level + first + second;
        assert!((f - expected).abs() < 1e-9, "{i}: {f} {expected}");
    }
}
