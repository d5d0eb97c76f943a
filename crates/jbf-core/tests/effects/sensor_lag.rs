//! Tests of a first-order low-pass filter against its responses to a step and to a ramp.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, Sines};
use crate::common::{chain, chain_round, readings, LOAD_N};

/// The response to a jump of the force between two samples is exponential, because the filter
/// treats it as a ramp over the step.
///
/// The ideal jump is at the middle of the ramp. The two responses differ by (dt/tau)^2/24.
#[test]
fn response_to_a_step_between_samples_is_exponential() {
    let (f, tau, dt) = (0.1, 0.3, 0.005);
    let chain = chain_round(ConstantLaw(f), &[("sensor_lag", &[tau])]);
    let got = readings(&chain, dt, 400, |t| {
        constant::<f64>(if t < 0.4975 { 0.1 } else { -0.1 }, t)
    });
    for (i, r) in got.iter().enumerate() {
        let since = dt * i as f64 - 0.4975;
        let expected = if since < 0.0 {
            1.0
        } else {
            2.0 * (-since / tau).exp() - 1.0
        };
        let bound = 2.0 * (dt / tau) * (dt / tau) / 24.0 * 1.01 + 1e-12;
        assert!(
            (r / (f * LOAD_N) - expected).abs() < bound,
            "sample {i}: {r}"
        );
    }
}

/// The response to a jump of the force at a sample, such as a reversal at a sample, is exact except
/// for rounding.
///
/// This also applies to the start and end of a motion.
#[test]
fn response_to_a_jump_at_a_sample_is_exact() {
    let (f, tau, dt) = (0.1, 0.3, 0.05);
    let chain = chain_round(ConstantLaw(f), &[("sensor_lag", &[tau])]);
    let speed = |t: f64| match (t / dt).round() as i32 {
        0 => 0.0,
        1..=39 => 0.1,
        40 => 0.0,
        41..=79 => -0.1,
        _ => 0.0,
    };
    let got = readings(&chain, dt, 120, |t| constant::<f64>(speed(t), t));
    let mut level = 0.0;
    for (i, r) in got.iter().enumerate().skip(1) {
        let target = [1.0, -1.0, 0.0][(i - 1) / 40];
        level = target + (level - target) * (-dt / tau).exp();
        assert!((r / (f * LOAD_N) - level).abs() < 1e-12, "sample {i}: {r}");
    }
}

/// A lag much shorter than a step shifts the reading by tau: r = F - tau F'.
#[test]
fn lag_shorter_than_a_step_shifts_the_reading() {
    let (tau, dt) = (1e-7, 0.01);
    let sines = Sines::one_way(1.0);
    let bare = readings(&chain::<f64>(&[]), dt, 300, |t| sines.at(t));
    let with = readings(&chain::<f64>(&[("sensor_lag", &[tau])]), dt, 300, |t| {
        sines.at(t)
    });
    for i in 1..bare.len() {
        let slope = (bare[i] - bare[i - 1]) / dt;
        assert!((with[i] - (bare[i] - tau * slope)).abs() < 1e-12);
    }
}

/// A lag much longer than the run hardly changes the first reading.
#[test]
fn lag_longer_than_the_run_holds_the_first_reading() {
    let sines = Sines::one_way(1.0);
    let with = readings(&chain::<f64>(&[("sensor_lag", &[100.0])]), 0.01, 100, |t| {
        sines.at(t)
    });
    let bare = readings(&chain::<f64>(&[]), 0.01, 100, |t| sines.at(t));
    assert_eq!(with[0], bare[0]);
    let swing = bare.iter().map(|b| (b - bare[0]).abs()).fold(0.0, f64::max);
    assert!(with.iter().all(|w| (w - with[0]).abs() <= 0.01 * swing));
}
