//! Tests that only the dry friction of the contact decays, exponentially in the sliding distance.

use crate::common::motion::constant;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn dry_friction_decays_exponentially_with_the_distance_slid() {
    let dt = 0.01;
    for (a, s_0) in [(0.2, 1.0), (-0.5, 0.05), (3.0, 0.3)] {
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &[("running_in", &[a, s_0])]);
        for speed in [0.05, -0.2] {
            let got = readings(&chain, dt, 500, |t| constant(speed, t));
            for (i, f) in got.iter().enumerate() {
                let slid = speed.abs() * dt * i as f64;
                let level = F_C_N * (1.0 + a * (-slid / s_0).exp());
                let expected = level * speed.signum() + F_V_N_S_M * speed;
                assert!((f - expected).abs() < 1e-11, "{a} {s_0} {speed} {i}: {f}");
            }
        }
    }
}

/// The distance of both directions is added, and a rest does not change it.
///
/// The speed is a triangle with its corners and zeros at samples, so that the distance is a
/// parabola.
#[test]
fn distance_accumulates_in_both_directions_but_not_at_rest() {
    let (a, s_0, dt) = (0.8, 0.02, 0.01);
    let chain = chain_round(newtons(F_C_N, 0.0), &[("running_in", &[a, s_0])]);
    // Up to 0.1 m/s and back to zero in 1 s, then in the other direction, then 1 s of rest.
    let speed = |t: f64| match t {
        t if t < 0.5 => 0.2 * t,
        t if t < 1.5 => 0.2 * (1.0 - t),
        t if t < 2.0 => 0.2 * (t - 2.0),
        _ => 0.0,
    };
    let slid = |t: f64| match t {
        t if t < 0.5 => 0.1 * t * t,
        t if t < 1.0 => 0.05 - 0.1 * (1.0 - t) * (1.0 - t),
        t if t < 1.5 => 0.05 + 0.1 * (t - 1.0) * (t - 1.0),
        t if t < 2.0 => 0.1 - 0.1 * (2.0 - t) * (2.0 - t),
        _ => 0.1,
    };
    let on_the_grid = |t: f64| (t / dt).round() * dt;
    let got = readings(&chain, dt, 300, |t| constant(speed(on_the_grid(t)), t));
    for (i, f) in got.iter().enumerate() {
        let t = dt * i as f64;
        if speed(on_the_grid(t)).abs() < 1e-9 {
            continue;
        }
        let expected = F_C_N * (1.0 + a * (-slid(t) / s_0).exp());
        assert!((f.abs() - expected).abs() < 1e-9, "{t}: {f} {expected}");
    }
    assert!((slid(2.0) - 0.1).abs() < 1e-15);
}
