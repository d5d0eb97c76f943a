//! Tests of a spring: a force `k x` in motion and at rest, which is not friction.

use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings};
use jbf_core::{Bearing, Motion};

const F_C_N: f64 = 6.0;

#[test]
fn force_is_proportional_to_the_position() {
    let sines = Sines::two_way(1.0);
    for k in [35.0, -4.0] {
        let chain = chain_round(newtons(F_C_N, 0.0), &[("spring", &[k])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let x = 0.127 * (1.0 - t.cos());
            let expected = F_C_N * t.sin().signum() + k * x;
            assert!((f - expected).abs() < 1e-9, "{k} {i}: {f} {expected}");
        }
    }
}

/// The force acts on a drive at rest; the friction level that holds the drive does not change.
#[test]
fn force_acts_at_rest_without_changing_the_holding_level() {
    let chain = chain_round(newtons(F_C_N, 0.0), &[("spring", &[20.0])]);
    let held = |t: f64| Motion {
        angle_rad: 1.1,
        ..constant::<f64>(0.0, t)
    };
    for r in readings(&chain, 0.01, 5, held) {
        assert!((r - 20.0 * 1.1 * Bearing::THESIS.radius_m).abs() < 1e-12);
    }
    let felt = chain.reaction_n(&chain.start(&held(0.0)));
    assert_eq!(felt.jump, F_C_N);
}

/// A gear that transmits the force of the spring loses a share of it.
#[test]
fn transmitted_force_causes_proportional_friction() {
    let sines = Sines::two_way(1.0);
    let effects: [(&str, &[f64]); 2] = [("spring", &[35.0]), ("torque_proportional", &[0.2])];
    let got = readings(
        &chain_round(newtons(F_C_N, 0.0), &effects),
        0.01,
        700,
        |t| sines.at::<f64>(t),
    );
    for (i, f) in got.iter().enumerate().skip(1) {
        let t = 0.01 * i as f64;
        let force = 35.0 * 0.127 * (1.0 - t.cos());
        let expected = (F_C_N + 0.2 * force) * t.sin().signum() + force;
        assert!((f - expected).abs() < 1e-9, "{i}: {f} {expected}");
    }
}
