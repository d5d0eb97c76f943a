//! Tests of a pure delay of the recorded force.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, Sines};
use crate::common::{chain, chain_round, readings, LOAD_N};

/// A delay of whole steps shifts the readings by this number of steps.
#[test]
fn delay_of_whole_steps_shifts_the_readings() {
    let sines = Sines::two_way(1.0);
    let bare = readings(&chain::<f64>(&[]), 0.01, 700, |t| sines.at(t));
    for steps in [1, 7, 40] {
        let tau = 0.01 * steps as f64;
        let late = readings(&chain::<f64>(&[("time_delay", &[tau])]), 0.01, 700, |t| {
            sines.at(t)
        });
        for i in 0..bare.len() {
            let expected = bare[i.saturating_sub(steps)];
            assert!((late[i] - expected).abs() < 1e-9, "{steps} {i}");
        }
    }
}

/// For a delay below one step, the reading is interpolated linearly between the adjacent samples.
#[test]
fn delay_below_one_step_interpolates_between_neighbours() {
    let sines = Sines::one_way(1.0);
    let bare = readings(&chain::<f64>(&[]), 0.01, 300, |t| sines.at(t));
    let late = readings(&chain::<f64>(&[("time_delay", &[0.003])]), 0.01, 300, |t| {
        sines.at(t)
    });
    for i in 1..bare.len() {
        let expected = 0.7 * bare[i] + 0.3 * bare[i - 1];
        assert!((late[i] - expected).abs() < 1e-12);
    }
}

/// A jump remains a jump, while a low-pass filter of the same delay smooths it.
#[test]
fn delayed_jump_is_not_smoothed() {
    let (f, tau, dt) = (0.1, 0.2, 0.01);
    let late = chain_round(ConstantLaw(f), &[("time_delay", &[tau])]);
    let got = readings(&late, dt, 200, |t| {
        constant::<f64>(if t < 0.4975 { 0.1 } else { -0.1 }, t)
    });
    for (i, r) in got.iter().enumerate() {
        let expected = if dt * (i as f64) < 0.4975 + tau - 0.005 {
            f
        } else {
            -f
        };
        assert!((r - expected * LOAD_N).abs() < 1e-9, "{i} {r}");
    }
}

/// Delay and low-pass filter commute, and both act before the offset of the load cell.
#[test]
fn delay_and_lag_commute() {
    let sines = Sines::one_way(1.0);
    let lag: (&str, &[f64]) = ("sensor_lag", &[0.1]);
    let lagged = readings(&chain::<f64>(&[lag]), 0.01, 400, |t| sines.at(t));
    let both = readings(
        &chain::<f64>(&[lag, ("time_delay", &[0.05])]),
        0.01,
        400,
        |t| sines.at(t),
    );
    for i in 5..lagged.len() {
        assert!((both[i] - lagged[i - 5]).abs() < 1e-9, "{i}");
    }
}
