//! Tests of a gear that carries a weight and a mass: friction is a fraction of the transmitted
//! force in both directions of power flow.

use crate::common::motion::{held, Sines};
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const WEIGHT: [f64; 2] = [30.0, 0.4];
const MASS_KG: f64 = 50.0;
const SHARE: f64 = 0.2;

/// Transmitted force at a time of the sinusoidal motion, N.
fn carried_n(t: f64) -> f64 {
    let theta = 10.0 * (1.0 - t.cos());
    WEIGHT[0] * (theta - WEIGHT[1]).sin() + MASS_KG * 0.127 * t.cos()
}

#[test]
fn loss_is_a_fraction_of_the_transmitted_force_in_both_directions() {
    let sines = Sines::two_way(1.0);
    let chain = chain_round(
        newtons(F_C_N, 0.0),
        &[
            ("gravity", &WEIGHT),
            ("inertia", &[MASS_KG]),
            ("torque_proportional", &[SHARE]),
        ],
    );
    let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
    let (mut drives, mut driven) = (0, 0);
    for (i, f) in got.iter().enumerate().skip(1) {
        let t = 0.01 * i as f64;
        let (carried, way) = (carried_n(t), t.sin().signum());
        // Driving requires 1 + mu times the load; driven back it returns 1 - mu times the load.
        let factor = if carried * way > 0.0 {
            drives += 1;
            1.0 + SHARE
        } else {
            driven += 1;
            1.0 - SHARE
        };
        let expected = F_C_N * way + factor * carried;
        assert!((f - expected).abs() < 1e-10, "{i}: {f} {expected}");
    }
    assert!(drives > 200 && driven > 200, "{drives} {driven}");
}

/// At rest, the drive holds up to the sum of both friction levels; with a fraction of 1, it is
/// self-locking.
#[test]
fn holding_level_at_rest_grows_with_the_transmitted_force() {
    for share in [0.0, 0.5, 1.0] {
        let effects: [(&str, &[f64]); 2] =
            [("gravity", &WEIGHT), ("torque_proportional", &[share])];
        let chain = chain_round(newtons(F_C_N, 0.0), &effects);
        let state = chain.start(&held::<f64>(2.0, 0.0));
        let weight = WEIGHT[0] * (2.0 - WEIGHT[1]).sin();
        let felt = chain.reaction_n(&state);
        assert!((felt.jump - (F_C_N + share * weight)).abs() < 1e-12);
        assert!((felt.smooth - weight).abs() < 1e-12);
    }
}

/// Drag is not a transmitted force.
#[test]
fn drag_is_not_transmitted() {
    let sines = Sines::two_way(1.0);
    let beside: [(&str, &[f64]); 1] = [("coulomb_drag", &[3.0])];
    let with = [beside.as_slice(), &[("torque_proportional", &[SHARE])]].concat();
    let [with, without] = [with.as_slice(), &beside].map(|effects| {
        readings(&chain_round(newtons(F_C_N, 1.0), effects), 0.01, 300, |t| {
            sines.at::<f64>(t)
        })
    });
    assert_eq!(with, without);
}

/// On an inclined axis the weight is constant and adds to the inertial force of the mass.
#[test]
fn constant_weight_on_an_inclined_axis_adds_to_the_transmitted_force() {
    let (sines, weight) = (Sines::two_way(1.0), 4.0);
    let chain = chain_round(
        newtons(F_C_N, 0.0),
        &[
            ("inertia", &[MASS_KG]),
            ("sensor_offset", &[weight]),
            ("torque_proportional", &[SHARE]),
        ],
    );
    let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
    for (i, f) in got.iter().enumerate().skip(1) {
        let t = 0.01 * i as f64;
        let carried = weight + MASS_KG * 0.127 * t.cos();
        let expected = carried + (F_C_N + SHARE * carried.abs()) * t.sin().signum();
        assert!((f - expected).abs() < 1e-10, "{i}: {f} {expected}");
    }
}

/// With presliding, friction proportional to the transmitted force changes gradually after a
/// reversal, like the dry friction of the law.
#[test]
fn loss_is_deflected_by_presliding_like_dry_friction() {
    let sines = Sines::two_way(1.0);
    let effects: [(&str, &[f64]); 3] = [
        ("gravity", &[30.0, -1.2]),
        ("torque_proportional", &[SHARE]),
        ("presliding", &[200.0]),
    ];
    let chain = chain_round(newtons(F_C_N, 0.0), &effects);
    let got = readings(&chain, 0.001, 4000, |t| sines.at::<f64>(t));
    let largest = got.windows(2).map(|w| (w[1] - w[0]).abs());
    assert!(largest.skip(1).fold(0.0, f64::max) < 0.1 * F_C_N);
}
