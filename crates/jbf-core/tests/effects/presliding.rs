//! Tests that friction after a reversal is exponential in the sliding distance, for any step, if
//! the sliding friction is constant.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;
use crate::common::{chain_round, readings, LOAD_N};
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::dahl::Dahl;
use jbf_core::law::Named;
use jbf_core::Clock;

const F: f64 = 0.2;
const SIGMA_1_M: f64 = 3e3;
const SPEED_M_S: f64 = 1e-3;

/// Readings relative to the sliding friction: forward from rest until the bristles slide, then
/// back.
fn reversal(dt_s: f64, forward: u32, back: u32) -> Vec<f64> {
    let chain = chain_round(ConstantLaw(F), &[("presliding", &[SIGMA_1_M])]);
    let turn = dt_s * (f64::from(forward) + 0.5);
    let speed = |t: f64| match t {
        0.0 => 0.0,
        t if t < turn => SPEED_M_S,
        _ => -SPEED_M_S,
    };
    readings(&chain, dt_s, forward + back, |t| {
        constant::<f64>(speed(t), t)
    })
    .iter()
    .map(|r| r / (F * LOAD_N))
    .collect()
}

#[test]
fn friction_after_a_start_or_reversal_is_exponential_in_the_distance() {
    let length = F / SIGMA_1_M;
    for dt_s in [1e-3, 0.01, 0.07] {
        let forward = (40.0 * length / (SPEED_M_S * dt_s)).ceil() as u32;
        let got = reversal(dt_s, forward, forward);
        for (i, r) in got.iter().enumerate().take(forward as usize) {
            // The first step starts from rest: its distance is half as long.
            let s = SPEED_M_S * dt_s * (i as f64 - 0.5).max(0.0);
            assert!(
                (r - (1.0 - (-s / length).exp())).abs() < 1e-12,
                "rise, {dt_s} s, {i}"
            );
        }
        for (i, r) in got.iter().enumerate().skip(forward as usize + 1) {
            // The speed crosses zero in the middle of a step, so a quarter of the step is slid
            // backward.
            let steps = i as f64 - f64::from(forward) - 1.0;
            let s = SPEED_M_S * dt_s * (steps + 0.25);
            assert!(
                (r - (2.0 * (-s / length).exp() - 1.0)).abs() < 1e-12,
                "{dt_s} s, {i}"
            );
        }
    }
}

/// A contact at rest keeps its deflection and does not creep back.
#[test]
fn deflection_is_kept_at_rest() {
    let chain = chain_round(ConstantLaw(F), &[("presliding", &[SIGMA_1_M])]);
    let got = readings(&chain, 0.01, 1000, |t| {
        constant::<f64>(
            if t > 0.0 && t < 0.0505 {
                SPEED_M_S
            } else {
                0.0
            },
            t,
        )
    });
    assert!(
        got[6] > 0.3 * F * LOAD_N && got[6] < F * LOAD_N,
        "{}",
        got[6]
    );
    assert!(got[6..].iter().all(|r| *r == got[6]));
}

/// A run that begins in motion begins with fully deflected bristles.
#[test]
fn bristles_are_fully_deflected_if_a_run_begins_in_motion() {
    let chain = chain_round(ConstantLaw(F), &[("presliding", &[SIGMA_1_M])]);
    for speed in [SPEED_M_S, -SPEED_M_S] {
        let got = readings(&chain, 0.01, 10, |t| constant::<f64>(speed, t));
        assert!(got
            .iter()
            .all(|r| (r - F * LOAD_N * speed.signum()).abs() < 1e-12));
    }
}

/// With a law in newtons, only dry friction deflects; with Coulomb's law, the result is Dahl's law
/// with the exponent 1.
#[test]
fn presliding_with_coulombs_law_equals_dahls_law() {
    let (kinetic_n, stiffness_n_m, viscous_n_s_m) = (6.0, 3e4, 400.0);
    let coulomb =
        Coulomb::build(None, None, &[kinetic_n, 9.0, viscous_n_s_m], Clock::Journal).unwrap();
    let dahl = Dahl::build(
        None,
        None,
        &[kinetic_n, stiffness_n_m, 1.0, viscous_n_s_m],
        Clock::Journal,
    )
    .unwrap();
    let speed = |t: f64| constant::<f64>(0.01 * (3.0 * t).sin() - 0.004 * (7.1 * t).sin(), t);
    let bent = chain_round(coulomb, &[("presliding", &[stiffness_n_m])]);
    let ours = readings(&bent, 1e-3, 5000, speed);
    let theirs = readings(&chain_round(dahl, &[]), 1e-3, 5000, speed);
    for (i, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        assert!((a - b).abs() < 1e-9 * kinetic_n, "{i}: {a} {b}");
    }
}

/// A reversal within a step is at the zero of the linearly interpolated speed.
///
/// Only the distance after this instant deflects the bristles backward.
#[test]
fn reversal_within_a_step_is_at_the_zero_of_the_interpolated_speed() {
    let chain = chain_round(ConstantLaw(F), &[("presliding", &[SIGMA_1_M])]);
    let dt_s = 0.01;
    for share in [0.2, 0.5, 0.75, 0.9] {
        // Speeds whose linear interpolation crosses zero at that share of the step.
        let (before, after) = (SPEED_M_S * share, -SPEED_M_S * (1.0 - share));
        let got = readings(&chain, dt_s, 20, |t| {
            constant::<f64>(if t < 10.5 * dt_s { before } else { after }, t)
        });
        for (i, r) in got.iter().enumerate() {
            let back = (1.0 - share) * dt_s * 0.5 + dt_s * (i as f64 - 11.0);
            let expected = if i < 11 {
                1.0
            } else {
                2.0 * (after * back * SIGMA_1_M / F).exp() - 1.0
            };
            assert!((r / (F * LOAD_N) - expected).abs() < 1e-12, "{share} {i}");
        }
    }
}
