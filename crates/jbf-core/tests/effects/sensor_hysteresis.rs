//! Tests of the hysteresis of a load cell: two branches that differ by 2 w, and constant readings
//! between them.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings, LOAD_N};
use jbf_core::effect::sensor_hysteresis::{Parameters, SensorHysteresis};
use jbf_core::effect::{Effect, Rig, Signal};
use jbf_core::{Dual, Motion, Real};

fn smooth<T: Real>(force_n: T) -> Signal<T> {
    Signal {
        begin_n: force_n,
        end_n: force_n,
        now_n: force_n,
    }
}

/// Readings of a load cell with a hysteresis of this half width for a sequence of forces, N.
fn read<T: Real>(half_width_n: T, forces_n: &[T]) -> Vec<T> {
    let cell = SensorHysteresis::new(Parameters { w: half_width_n }).expect("within bounds");
    let mut state = cell.start(&Motion::default(), &Rig::default());
    let mut first_n = forces_n[0];
    cell.first_reading(&mut state, &mut first_n);
    let mut readings_n = vec![first_n];
    for &force in &forces_n[1..] {
        let mut signal = smooth(force);
        cell.reading(&mut state, &mut signal, T::ZERO, T::ONE);
        readings_n.push(signal.now_n);
    }
    readings_n
}

/// The test motion has a speed that rises, falls below zero and rises again, with viscous friction.
///
/// The reading follows the branch F - w, is constant from a peak until the force is 2 w lower, and
/// then follows the branch F + w.
#[test]
fn reading_follows_the_branches_and_is_constant_within_the_gap() {
    let (w, slope, n) = (0.4, 40.0, 628);
    let force = |t: f64| slope * 0.1 * t.sin();
    let chain = chain_round(newtons(1e-6, slope), &[("sensor_hysteresis", &[w])]);
    let got = readings(&chain, 0.01, n, |t| constant::<f64>(0.1 * t.sin(), t));
    let peak = slope * 0.1;
    for (i, r) in got.iter().enumerate() {
        let t = 0.01 * i as f64;
        let expected = if t < core::f64::consts::FRAC_PI_2 {
            (force(t) - w).max(0.0)
        } else if t < 1.5 * core::f64::consts::PI {
            (force(t) + w).min(peak - w)
        } else {
            (force(t) - w).max(w - peak)
        };
        // A peak between two samples is read at the higher of them.
        assert!((r - expected).abs() < 2e-4 * peak, "{i}: {r} {expected}");
    }
    let touched = got
        .iter()
        .filter(|r| (*r - (peak - w)).abs() < 1e-4)
        .count();
    assert!(touched > 20, "the level is {touched} samples long");
}

/// After a jump larger than the width of the hysteresis, the reading is closer to zero than the
/// force by w, from the sample of the jump on.
#[test]
fn reading_follows_a_jump_larger_than_the_hysteresis_at_its_sample() {
    let (f, w, dt) = (0.1, 1.5, 0.05);
    let chain = chain_round(ConstantLaw(f), &[("sensor_hysteresis", &[w])]);
    let speed = |t: f64| match (t / dt).round() as i32 {
        0 => 0.0,
        1..=39 => 0.1,
        40 => 0.0,
        41..=79 => -0.1,
        _ => 0.0,
    };
    let got = readings(&chain, dt, 120, |t| constant::<f64>(speed(t), t));
    let level = f * LOAD_N;
    for (i, r) in got.iter().enumerate() {
        let expected = match i {
            0 => 0.0,
            1..=39 => level - w,
            // At the instant of the reversal there is no friction, and the play holds w.
            40 => w,
            41..=79 => w - level,
            _ => -w,
        };
        assert!((r - expected).abs() < 1e-12, "{i}: {r} {expected}");
    }
}

/// A single sample at zero speed, where the friction is zero, does not change later readings.
#[test]
fn sample_at_zero_speed_does_not_change_the_readings_of_the_other_samples() {
    let (f, w, dt) = (0.1, 1.5, 0.05);
    let chain = chain_round(ConstantLaw(f), &[("sensor_hysteresis", &[w])]);
    let touches = |t: f64| if (t - 1.0).abs() < 1e-9 { 0.0 } else { 0.1 };
    let got = readings(&chain, dt, 60, |t| constant::<f64>(touches(t), t));
    for (i, r) in got.iter().enumerate() {
        let expected = if i == 20 { w } else { f * LOAD_N };
        assert!((r - expected).abs() < 1e-12, "{i}: {r} {expected}");
    }
}

/// A change smaller than the width 2 w does not change the reading, whose difference from the force
/// is at most w.
#[test]
fn change_smaller_than_the_hysteresis_does_not_change_the_reading() {
    let ripple: Vec<f64> = (0..200)
        .map(|i| 5.0 + 0.3 * (0.1 * f64::from(i)).sin())
        .collect();
    assert!(read(0.31, &ripple).iter().all(|&r| r == ripple[0]));
    for w in [0.0, 1e-9, 0.1, 1e5] {
        for (r, f) in read(w, &ripple).iter().zip(&ripple) {
            assert!((r - f).abs() <= w + 1e-12);
        }
    }
}

/// The hysteresis is rate-independent and odd.
///
/// The same forces at any rate give the same readings, and opposite forces give opposite readings.
#[test]
fn hysteresis_is_rate_independent_and_odd() {
    let forces: Vec<f64> = (0..300)
        .map(|i| 9.0 * (0.07 * f64::from(i)).sin() + 4.0 * (0.19 * f64::from(i)).cos())
        .collect();
    let halves: Vec<f64> = (0..599)
        .map(|i| 0.5 * (forces[i / 2] + forces[i.div_ceil(2)]))
        .collect();
    let mirrored: Vec<f64> = forces.iter().map(|f| -f).collect();
    let once = read(0.8, &forces);
    for (i, r) in read(0.8, &halves).iter().step_by(2).enumerate() {
        assert_eq!(*r, once[i]);
    }
    for (r, m) in once.iter().zip(read(0.8, &mirrored)) {
        assert_eq!(*r, -m);
    }
}

/// At zero width, the derivative with respect to the force is that of the force itself.
///
/// The derivative with respect to the width is that of the branch on which the force last moved.
/// This is also true while the force is constant and only its derivative changes.
#[test]
fn derivative_at_zero_width_is_that_of_the_branch() {
    let w = Dual::<2>::parameter(0.0, 0);
    let steps = [
        (3.0, 1.0),
        (4.0, 2.0),
        (4.0, 5.0),
        (2.0, 6.0),
        (2.0, 7.0),
        (2.5, 8.0),
    ];
    let forces = steps.map(|(value, slope)| Dual::<2> {
        value,
        slope: [0.0, slope],
    });
    let found = read(w, &forces);
    let branches = [0.0, -1.0, -1.0, 1.0, 1.0, -1.0];
    for ((r, f), branch) in found.iter().zip(forces).zip(branches) {
        assert_eq!((r.value, r.slope), (f.value, [branch, f.slope[1]]));
    }
    for zero in [0.0, -0.0] {
        let r = read(0.0_f64, &[1.0, zero, 2.0, zero]);
        assert_eq!(r[1].to_bits(), f64::to_bits(zero));
        assert_eq!(r[3].to_bits(), f64::to_bits(zero));
    }
}

/// At a positive width, the derivative is that of the branch while the reading follows the force.
///
/// The derivative is constant while the reading is constant.
#[test]
fn derivative_at_positive_width_is_that_of_the_moving_end() {
    let w = Dual::<2>::parameter(0.5, 0);
    let steps = [(3.0, 1.0), (4.0, 2.0), (3.5, 5.0), (2.0, 6.0), (2.4, 7.0)];
    let forces = steps.map(|(value, slope)| Dual::<2> {
        value,
        slope: [0.0, slope],
    });
    let found = read(w, &forces);
    let expected = [
        (3.0, [0.0, 1.0]),
        (3.5, [-1.0, 2.0]),
        (3.5, [-1.0, 2.0]),
        (2.5, [1.0, 6.0]),
        (2.5, [1.0, 6.0]),
    ];
    for (r, (value, slope)) in found.iter().zip(expected) {
        assert_eq!((r.value, r.slope), (value, slope));
    }
}

/// Hysteresis acts before the nonlinearity of the load cell.
///
/// The branches of a nonlinear cell are the transformed branches of the linear one.
#[test]
fn hysteresis_acts_before_the_nonlinearity_of_the_cell() {
    let (w, c) = (0.6, 4e-3);
    let sines = Sines::two_way(1.0);
    let play: (&str, &[f64]) = ("sensor_hysteresis", &[w]);
    let bent: (&str, &[f64]) = ("sensor_nonlinearity", &[c]);
    let [held, both] = [vec![play], vec![play, bent]].map(|effects| {
        let chain = chain_round(newtons(6.0, 40.0), &effects);
        readings(&chain, 0.01, 700, |t| sines.at::<f64>(t))
    });
    for (r, h) in both.iter().zip(&held) {
        assert!((r - (h + c * h.powi(3))).abs() < 1e-12);
    }
}
