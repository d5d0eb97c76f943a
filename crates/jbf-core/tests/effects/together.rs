//! Tests of combinations of effects: two whose combination has a closed form, every pair, and all
//! at once.

use crate::common::motion::Sines;
use crate::common::{chain, chain_round, company, law, readings};
use jbf_core::effect::{Info, CATALOGUE};
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::{self, Named};
use jbf_core::{Clock, Real};

fn starts(info: &Info) -> Vec<f64> {
    info.parameters.iter().map(|p| p.starts[0]).collect()
}

/// Readings with the effects `which` at their starting values and the effects `beside`, which some
/// of them require.
fn run<T: Real>(which: &[&Info], beside: &[(&str, &[f64])]) -> Vec<T> {
    let values: Vec<Vec<f64>> = which.iter().map(|info| starts(info)).collect();
    let effects: Vec<(&str, &[f64])> = which
        .iter()
        .zip(&values)
        .map(|(info, v)| (info.name, v.as_slice()))
        .chain(beside.iter().copied())
        .collect();
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    readings(&chain::<T>(&effects), 0.01, 700, |t| sines.under(83.5, t))
}

/// The instrument acts after the drag on the force.
///
/// A low-pass filter, implemented here, of the force with drag equals the chain with both effects.
#[test]
fn lag_of_the_instrument_filters_the_force_with_drag() {
    let (tau, dt) = (0.1_f64, 0.01_f64);
    let sines = Sines::one_way(1.0);
    let drag: (&str, &[f64]) = ("coulomb_drag", &[2.0]);
    let force = readings(&chain::<f64>(&[drag]), dt, 700, |t| sines.at(t));
    let both = readings(
        &chain::<f64>(&[drag, ("sensor_lag", &[tau])]),
        dt,
        700,
        |t| sines.at(t),
    );
    // Substeps of the ramp between samples, with the trapezoidal rule.
    let n = 200;
    let h = dt / f64::from(n);
    let mut r = force[0];
    for i in 1..force.len() {
        for k in 0..n {
            let at =
                |k: i32| force[i - 1] + (force[i] - force[i - 1]) * f64::from(k) / f64::from(n);
            let gain = h / (2.0 * tau);
            r = (r * (1.0 - gain) + gain * (at(k) + at(k + 1))) / (1.0 + gain);
        }
        assert!((both[i] - r).abs() < 1e-6, "sample {i}: {} {r}", both[i]);
    }
}

/// The order in which two effects are named does not change the readings.
///
/// The order in the chain is fixed, and both effects act.
#[test]
fn order_of_names_of_two_effects_does_not_change_the_readings() {
    for (i, a) in CATALOGUE.iter().enumerate() {
        for b in &CATALOGUE[i + 1..] {
            let mut beside = [company(a), company(b)].concat();
            beside.retain(|(name, _)| ![a.name, b.name].contains(name));
            let one = run::<f64>(&[a, b], &beside);
            let other = run::<f64>(&[b, a], &beside);
            assert_eq!(one, other, "{} {}", a.name, b.name);
            assert!(one.iter().all(|r| r.is_finite()));
            for single in [a, b] {
                let alone = run::<f64>(&[single], &beside);
                let apart = one
                    .iter()
                    .zip(&alone)
                    .map(|(x, y)| (x - y).abs())
                    .fold(0.0, f64::max);
                assert!(apart > 1e-3, "{} with {}: {apart}", a.name, b.name);
            }
        }
    }
}

/// Readings with every effect that is compatible with a law, all at once.
fn all_round<T: Real, L: Named<T>>(law: L) -> Vec<T> {
    let page = law::CATALOGUE.iter().find(|page| page.name == L::INFO.name);
    let page = page.expect("a law of the catalogue");
    let all = CATALOGUE.iter().filter(|e| e.lacking(page).is_none());
    let values: Vec<(&str, Vec<f64>)> = all.map(|e| (e.name, starts(e))).collect();
    let effects: Vec<(&str, &[f64])> = values.iter().map(|(n, v)| (*n, v.as_slice())).collect();
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    readings(&chain_round(law, &effects), 0.01, 700, |t| {
        sines.under(83.5, t)
    })
}

fn agree(double: &[f64], single: &[f32]) {
    let peak = double.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    assert!(peak > 1.0 && peak < 1e3, "{peak}");
    for (a, b) in double.iter().zip(single) {
        assert!((a - f64::from(*b)).abs() < 1e-3 * peak, "{a} {b}");
    }
}

#[test]
fn all_effects_together_are_finite_and_agree_in_both_precisions() {
    agree(
        &all_round(law::<f64>(Clock::Journal)),
        &all_round(law::<f32>(Clock::Journal)),
    );
    agree(&all_round(dry::<f64>()), &all_round(dry::<f32>()));
}

/// Law in newtons with dry and viscous friction.
fn dry<T: Real>() -> Coulomb<T> {
    let values = [6.0, 6.0, 20.0].map(T::of);
    Coulomb::build(None, None, &values, Clock::Journal).expect("a sound law")
}
