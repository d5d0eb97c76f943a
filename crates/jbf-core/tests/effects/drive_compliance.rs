//! Tests of a compliant drive: static deflection, oscillation with and without dry friction,
//! sticking without drift.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, held};
use crate::common::{chain_round, on_drive, readings, LOAD_N};
use jbf_core::Motion;
use std::f64::consts::{PI, TAU};

const K: f64 = 60.0;
const J: f64 = 2e-3;
const AMPLITUDE_M: f64 = 0.01;
/// Product n R of the number of bearings and the radius, m.
const ARM_M: f64 = 4.0 * 0.0127;

/// Journal angles along a motion (rad), for a Coulomb friction `f` and a damping `c`.
fn angles(f: f64, c: f64, dt_s: f64, steps: u32, motion: impl Fn(f64) -> Motion<f64>) -> Vec<f64> {
    let chain = chain_round(ConstantLaw(f), &[("drive_compliance", &[K, c, J])]);
    let mut state = chain.start(&motion(0.0));
    (1..=steps)
        .map(|i| {
            chain.step(&mut state, &motion(dt_s * f64::from(i)), dt_s);
            state.journal.angle_rad
        })
        .collect()
}

/// Motion of the encoder side at rest; the journal is released a hundredth of a radian away from
/// it.
fn let_go(t: f64) -> Motion<f64> {
    held(if t == 0.0 { 0.0 } else { 0.01 }, t)
}

/// Local extremes of a signal: index and value.
fn extremes(signal: &[f64]) -> Vec<(usize, f64)> {
    (1..signal.len() - 1)
        .filter(|&i| (signal[i] - signal[i - 1]) * (signal[i + 1] - signal[i]) < 0.0)
        .map(|i| (i, signal[i]))
        .collect()
}

/// In steady rotation the journal lags by n R F / k, and the damper has no influence.
#[test]
fn journal_lags_by_the_static_twist_in_steady_rotation() {
    let f = 0.1;
    let speed = 0.05;
    let got = angles(f, 0.1, 1e-3, 20_000, |t| constant(speed, t));
    let encoder = constant::<f64>(speed, 20.0).angle_rad;
    let twist = ARM_M * f * LOAD_N / K;
    assert!(
        (encoder - got[got.len() - 1] - twist).abs() < 1e-9,
        "{twist}"
    );
}

/// Without friction the journal oscillates with the period 2 pi sqrt(J/k).
///
/// The midpoint rule lengthens the period by (w dt)^2/24 and preserves the amplitude.
#[test]
fn journal_without_friction_oscillates_with_its_natural_period() {
    let period = TAU * (J / K).sqrt();
    let dt = period / 200.0;
    let got = angles(0.0, 1e-5, dt, 4100, let_go);
    let turns = extremes(&got);
    assert!(turns.len() >= 39, "{}", turns.len());
    let (first, last) = (turns[0], turns[38]);
    let measured = (last.0 - first.0) as f64 * dt / 19.0;
    assert!(
        (measured / period - 1.0).abs() < 1e-3,
        "{measured} {period}"
    );
    let decay = (-1e-5 / (2.0 * J) * 19.0 * period).exp();
    assert!(((last.1 - 0.01) / (first.1 - 0.01) / decay - 1.0).abs() < 1e-3);
}

/// With dry friction, the amplitude decreases by 2 n R F / k per half period, and then the journal
/// sticks.
#[test]
fn amplitude_falls_by_a_constant_per_half_period_with_dry_friction() {
    let f = 0.005;
    let bite = 2.0 * ARM_M * f * LOAD_N / K;
    let dt = TAU * (J / K).sqrt() / 2000.0;
    let got = angles(f, 1e-5, dt, 20_000, let_go);
    let mut reach = 0.01;
    let turns = extremes(&got);
    for (n, (_, angle)) in turns.iter().enumerate() {
        reach -= bite;
        assert!(
            ((angle - 0.01).abs() - reach).abs() < 2e-5,
            "half swing {n}"
        );
    }
    // It stops where the next swing could not begin: within the dead zone bite / 2.
    let rest = got[got.len() - 1];
    assert!((rest - 0.01).abs() <= bite / 2.0);
    assert!(got[got.len() - 5000..].iter().all(|a| *a == rest));
}

/// A torque below the sliding friction never moves the journal, and the load cell measures this
/// torque.
#[test]
fn journal_sticks_below_the_sliding_friction_and_the_cell_reads_the_torque() {
    let f = 0.2;
    let slip = ARM_M * f * LOAD_N;
    for share in [0.1, 0.5, 0.999] {
        let angle = share * slip / K;
        let motion = |t: f64| held(if t == 0.0 { 0.0 } else { angle }, t);
        let got = angles(f, 0.1, 1e-3, 100_000, motion);
        assert!(got.iter().all(|a| *a == 0.0), "{share}");
        let chain = chain_round(ConstantLaw(f), &[("drive_compliance", &[K, 0.1, J])]);
        let cell = readings(&chain, 1e-3, 100, motion);
        assert!(
            (cell[100] - K * angle / ARM_M).abs() < 1e-9,
            "{share}: {}",
            cell[100]
        );
    }
    let over = angles(f, 0.1, 1e-3, 1000, |t| {
        held(if t == 0.0 { 0.0 } else { 1.01 * slip / K }, t)
    });
    assert!(over[999] > 0.0, "just above, it slips");
}

/// Sine motion of a slide, with exact acceleration.
fn swing(omega: f64, t: f64) -> Motion<f64> {
    let (sin, cos) = (omega * t).sin_cos();
    Motion {
        time_s: t,
        angle_rad: AMPLITUDE_M * sin,
        velocity_m_s: AMPLITUDE_M * omega * cos,
        acceleration_m_s2: -AMPLITUDE_M * omega * omega * sin,
        ..Motion::at_rest(LOAD_N)
    }
}

/// At a drive, the force contains the inertia ahead of the spring and the torque of the spring.
///
/// With J behind the spring and M - J ahead of it, the response to the angle of the drive is
/// -w^2 (M - J) - J w^2 (k + i w c) / (k + i w c - J w^2): below the resonance the whole inertia M,
/// above it M - J.
#[test]
fn force_at_a_drive_is_the_frequency_response_of_two_masses() {
    let (total, c) = (5e-3, 0.05);
    let inertia: &[f64] = &[total];
    let chain = on_drive(
        ConstantLaw(0.0),
        &[("inertia", inertia), ("drive_compliance", &[K, c, J])],
    );
    let resonance = (K / J).sqrt();
    for share in [0.2, 0.8, 1.5, 4.0] {
        let omega = share * resonance;
        let dt = TAU / omega / 1000.0;
        // The free oscillation decays with the time constant 2 J / c.
        let (settled, steps) = ((0.6 / dt) as usize, (0.6 / dt) as u32 + 1000);
        let got = readings(&chain, dt, steps, |t| swing(omega, t));
        // Quotient (re + i im) of (k + i w c) and (k - J w^2 + i w c).
        let (stiff, damped) = (K - J * omega * omega, omega * c);
        let square = stiff * stiff + damped * damped;
        let re = (K * stiff + damped * damped) / square;
        let im = damped * (stiff - K) / square;
        let size = AMPLITUDE_M * omega * omega;
        for (i, reading) in got.iter().enumerate().skip(settled) {
            let (sin, cos) = (omega * dt * i as f64).sin_cos();
            let expected = -size * ((total - J) * sin + J * (re * sin + im * cos));
            let error = (reading - expected).abs();
            assert!(error < 0.01 * size * total, "{share} {i}: {error}");
        }
    }
}

/// A stiff spring does not change the force of a drive.
#[test]
fn force_at_a_drive_with_a_stiff_spring_is_that_of_a_rigid_one() {
    let inertia: (&str, &[f64]) = ("inertia", &[5e-3]);
    let spring: (&str, &[f64]) = ("drive_compliance", &[1e7, 100.0, J]);
    let (rigid, stiff) = (
        on_drive(ConstantLaw(0.1), &[inertia]),
        on_drive(ConstantLaw(0.1), &[inertia, spring]),
    );
    let forces = [rigid, stiff].map(|chain| readings(&chain, 1e-3, 2000, |t| swing(3.0, t)));
    for (i, (a, b)) in forces[0].iter().zip(&forces[1]).enumerate() {
        // After a reversal, the force of the spring changes from -F to F and then oscillates.
        let since_reversal_s = (3e-3 * i as f64 + 0.5 * PI) % PI / 3.0;
        let turned = since_reversal_s < 0.01;
        assert!(turned || (a - b).abs() < 0.01, "{i}: {a} {b}");
    }
}
