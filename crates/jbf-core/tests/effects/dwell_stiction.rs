//! Tests that friction after a rest of length t_d is higher by `a (1 - exp(-(t_d/t_0)^m))
//! exp(-s/s_0)`, with s the sliding distance since the rest.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;
use crate::common::{chain_round, readings, LOAD_N};

const F: f64 = 0.1;
const DT_S: f64 = 0.01;
const SPEED_M_S: f64 = 0.02;

/// Indices of the samples at which two rests begin and end.
const RESTS: [[usize; 2]; 2] = [[50, 300], [500, 580]];

/// Speed at a sample, m/s: forward, a rest, backward, a shorter rest, forward.
fn speed(i: usize) -> f64 {
    let [first, second] = RESTS;
    match i {
        i if i < first[0] => SPEED_M_S,
        i if i <= first[1] => 0.0,
        i if i < second[0] => -SPEED_M_S,
        i if i <= second[1] => 0.0,
        _ => SPEED_M_S,
    }
}

#[test]
fn stiction_grows_during_a_rest_and_decays_with_the_distance_slid() {
    for [a, t_0, m, s_0] in [
        [0.08, 3.0, 0.7, 2e-3],
        [0.3, 0.5, 1.0, 2e-2],
        [0.05, 1.0, 2.5, 5e-3],
    ] {
        let chain = chain_round(ConstantLaw(F), &[("dwell_stiction", &[a, t_0, m, s_0])]);
        let got = readings(&chain, DT_S, 800, |t| {
            constant::<f64>(speed((t / DT_S).round() as usize), t)
        });
        for (i, f) in got.iter().enumerate().filter(|(i, _)| speed(*i) != 0.0) {
            let rest = RESTS.iter().rev().find(|rest| rest[1] < i);
            let excess = rest.map_or(0.0, |&[from, to]| {
                let stood_s = DT_S * (to - from) as f64;
                // The step that ends the rest begins at zero speed: its distance is half as long.
                let slid_m = SPEED_M_S * DT_S * (i as f64 - to as f64 - 0.5);
                a * (1.0 - (-(stood_s / t_0).powf(m)).exp()) * (-slid_m / s_0).exp()
            });
            let expected = (F + excess) * LOAD_N * speed(i).signum();
            assert!((f - expected).abs() < 1e-10, "{a} {i}: {f} {expected}");
        }
    }
}
