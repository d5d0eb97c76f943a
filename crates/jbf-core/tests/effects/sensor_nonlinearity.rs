//! Tests of a load cell with a cubic term against forces whose cube is known.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings, LOAD_N};
use jbf_core::effect::sensor_nonlinearity::{Parameters, SensorNonlinearity};
use jbf_core::effect::{Effect, Signal};
use jbf_core::{Dual, Real};

fn read<T: Real>(cubic_1_n2: T, mut force_n: T) -> T {
    let cell = SensorNonlinearity::new(Parameters { c: cubic_1_n2 }).expect("within bounds");
    cell.first_reading(&mut (), &mut force_n);
    force_n
}

#[test]
fn cubic_term_is_added_to_every_reading() {
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let plain = readings(&chain_round(newtons(6.0, 40.0), &[]), 0.01, 700, |t| {
        sines.at::<f64>(t)
    });
    // Either sign, and two magnitudes.
    for c in [2e-3, -5e-4] {
        let bent = chain_round(newtons(6.0, 40.0), &[("sensor_nonlinearity", &[c])]);
        let got = readings(&bent, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, (r, f)) in got.iter().zip(&plain).enumerate() {
            let expected = f * (1.0 + c * f.powi(2));
            assert!((r - expected).abs() < 1e-13 * 12.0, "{c} {i}: {r}");
        }
    }
}

/// The nonlinearity acts before lag and offset: both sides of a jump are transformed, and a load
/// cell with lag settles at the transformed force.
#[test]
fn nonlinearity_acts_before_lag_and_offset() {
    let (f, c, b, tau, dt) = (0.1, 5e-3, 0.7, 0.3, 0.05);
    let effects: [(&str, &[f64]); 3] = [
        ("sensor_nonlinearity", &[c]),
        ("sensor_lag", &[tau]),
        ("sensor_offset", &[b]),
    ];
    let chain = chain_round(ConstantLaw(f), &effects);
    let back = |t: f64| if t < 0.99 { 0.1 } else { -0.1 };
    let got = readings(&chain, dt, 60, |t| {
        let speed = if (t - 1.0).abs() < 1e-9 { 0.0 } else { back(t) };
        crate::common::motion::constant::<f64>(speed, t)
    });
    let level = f * LOAD_N * (1.0 + c * (f * LOAD_N) * (f * LOAD_N));
    for (i, r) in got.iter().enumerate() {
        let since = (dt * i as f64 - 1.0).max(0.0);
        let expected = level * (2.0 * (-since / tau).exp() - 1.0) + b;
        assert!((r - expected).abs() < 1e-12 * level, "{i}: {r} {expected}");
    }
}

/// The reading never decreases with the force, and is always finite.
#[test]
fn characteristic_is_monotone_odd_and_finite() {
    for c in [-1e6, -3e-3, -1e-12, 0.0, 1e-12, 3e-3, 1e6] {
        let mut last = f64::NEG_INFINITY;
        for k in -400..=400 {
            let force = f64::from(k) * 0.25;
            let r = read(c, force);
            assert!(r >= last, "{c} {force}: {r} after {last}");
            assert_eq!(read(c, -force), -r);
            last = r;
        }
        for force in [1e-30_f32, 1.0, 1e9, 1e19, 1e30] {
            assert!(read(c as f32, force).is_finite(), "{c} {force}");
        }
    }
    // From its turning point on the characteristic is constant, without a step.
    let (c, turning) = (-1.0 / 300.0, 10.0);
    assert!((read(c, turning) - 20.0 / 3.0).abs() < 1e-14);
    assert!((read(c, 1.001 * turning) - read(c, 0.999 * turning)).abs() < 1e-4);
    assert_eq!(read(c, 40.0), read(c, 30.0));
}

#[test]
fn derivatives_are_those_of_the_characteristic_on_both_sides_of_its_turning_point() {
    let c = Dual::<2>::parameter(2e-3, 0);
    let force = Dual::<2>::parameter(-8.0, 1);
    let r = read(c, force);
    assert!((r.slope[0] + 512.0).abs() < 1e-12);
    assert!((r.slope[1] - (1.0 + 3.0 * 2e-3 * 64.0)).abs() < 1e-15);
    // Beyond the turning point the derivative with respect to the force is zero, that to c is not.
    let c = Dual::<2>::parameter(-1.0 / 300.0, 0);
    let r = read(c, Dual::parameter(-30.0, 1));
    let beside = |by: f64| read(-1.0 / 300.0 + by, -30.0);
    let slope = (beside(1e-7) - beside(-1e-7)) / 2e-7;
    assert!((r.slope[0] / slope - 1.0).abs() < 1e-6, "{:?} {slope}", r);
    assert_eq!(r.slope[1], 0.0);
}

/// The force at each instant within a step is transformed separately.
#[test]
fn nonlinearity_transforms_each_instant_of_a_step_separately() {
    let cell = SensorNonlinearity::new(Parameters { c: 0.01 }).expect("within bounds");
    let mut signal = Signal {
        begin_n: 1.0,
        end_n: -2.0,
        now_n: 3.0,
    };
    cell.reading(&mut (), &mut signal, 5.0, 0.1);
    assert_eq!(
        signal,
        Signal {
            begin_n: 1.01,
            end_n: -2.08,
            now_n: 3.27
        }
    );
}
