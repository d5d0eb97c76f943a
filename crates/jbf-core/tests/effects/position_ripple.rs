//! Tests of a friction ripple with one period per turn and its maximum at theta_0.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings, LOAD_N};
use std::f64::consts::TAU;

#[test]
fn ripple_has_one_maximum_per_turn_at_theta_0() {
    let (depth, theta_0, f) = (0.3, 0.8, 0.1);
    let chain = chain_round(ConstantLaw(f), &[("position_ripple", &[depth, theta_0])]);
    // 1000 steps per turn, two turns.
    let speed = 0.05;
    let dt = TAU * 0.0127 / speed / 1000.0;
    let readings = readings(&chain, dt, 2000, |t| constant::<f64>(speed, t));
    let turn = &readings[..1000];
    let (at, largest) = turn
        .iter()
        .enumerate()
        .fold((0, 0.0), |m, (i, &r)| if r > m.1 { (i, r) } else { m });
    let smallest = turn.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((TAU * at as f64 / 1000.0 - theta_0).abs() < TAU / 1000.0);
    assert!((largest / (f * LOAD_N) - (1.0 + depth)).abs() < 1e-5);
    assert!((smallest / (f * LOAD_N) - (1.0 - depth)).abs() < 1e-5);
    // The mean over a turn is the friction without ripple, and the next turn is equal.
    assert!((turn.iter().sum::<f64>() / 1000.0 - f * LOAD_N).abs() < 1e-9);
    for (a, b) in turn.iter().zip(&readings[1000..]) {
        assert!((a - b).abs() < 1e-9);
    }
    // One maximum per turn: the signal crosses its mean twice.
    let above: Vec<bool> = turn.iter().map(|r| *r > f * LOAD_N).collect();
    assert_eq!(above.windows(2).filter(|w| w[0] != w[1]).count(), 2);
}

/// Dry and viscous friction follow the cosine at every angle.
#[test]
fn dry_and_viscous_friction_follow_the_cosine_of_the_angle() {
    let (f_c, f_v) = (6.0, 40.0);
    let sines = Sines::two_way(1.0);
    for (a, theta_0) in [(0.1, -1.3), (0.9, 2.0)] {
        let chain = chain_round(newtons(f_c, f_v), &[("position_ripple", &[a, theta_0])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, r) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let (v, theta) = (0.127 * t.sin(), 10.0 * (1.0 - t.cos()));
            let expected = (f_c * v.signum() + f_v * v) * (1.0 + a * (theta - theta_0).cos());
            assert!((r - expected).abs() < 1e-11, "{t}: {r} {expected}");
        }
    }
}
