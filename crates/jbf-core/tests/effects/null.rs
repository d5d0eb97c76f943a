//! Tests that the readings with an effect at its null value equal those of the base law bit for
//! bit.

use crate::common::motion::Sines;
use crate::common::random::Random;
use crate::common::{chain, company, readings};
use jbf_core::effect::{Info, Need, CATALOGUE};
use jbf_core::{Motion, Real};

/// Parameters of an effect at its null value; the other parameters are random.
fn at_null(info: &Info, random: &mut Random) -> Vec<f64> {
    info.parameters
        .iter()
        .map(|p| p.null.unwrap_or_else(|| random.parameter(p)))
        .collect()
}

fn check<T: Real>() {
    let mut random = Random::new(1);
    for info in CATALOGUE {
        assert!(
            info.parameters.iter().any(|p| p.null.is_some()),
            "{} has no null",
            info.name
        );
        for _ in 0..20 {
            let motion = Sines::random(&mut random);
            let values = at_null(info, &mut random);
            let swinging = |t: f64| motion.under(104.0 + 30.0 * (2.0 * t).sin(), t);
            let company = company(info);
            let whole = [company.as_slice(), &[(info.name, &values)]].concat();
            let bare = readings(&chain::<T>(&company), 0.01, 500, swinging);
            let with = readings(&chain::<T>(&whole), 0.01, 500, swinging);
            assert!(bare.iter().any(|&r| r != T::ZERO));
            for (a, b) in bare.iter().zip(&with) {
                assert_eq!(
                    a.value().to_bits(),
                    b.value().to_bits(),
                    "{} {values:?}",
                    info.name
                );
            }
        }
    }
}

#[test]
fn effect_at_its_null_changes_no_bit_in_double_precision() {
    check::<f64>();
}

#[test]
fn effect_at_its_null_changes_no_bit_in_single_precision() {
    check::<f32>();
}

/// An effect that depends on the temperature changes no bit of the readings if no temperature was
/// recorded.
#[test]
fn temperature_effects_change_no_bit_if_no_temperature_is_recorded() {
    let sines = Sines::two_way(1.0);
    let nowhere = |t: f64| {
        let mut motion: Motion<f64> = sines.at(t);
        motion.temperature_c = None;
        motion
    };
    let bare = readings(&chain(&[]), 0.01, 300, nowhere);
    let asks = |info: &&Info| info.needs.contains(&Need::Temperatures);
    let all: Vec<&Info> = CATALOGUE.iter().filter(asks).collect();
    assert!(all.len() >= 3);
    for info in all {
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let with = chain(&[(info.name, &values)]);
        assert_eq!(bare, readings(&with, 0.01, 300, nowhere), "{}", info.name);
        assert_ne!(bare, readings(&with, 0.01, 300, |t| sines.at(t)));
    }
}

/// Every effect changes the readings away from its null value, so that the tests of null values can
/// fail.
#[test]
fn every_effect_changes_the_readings_away_from_its_null() {
    for info in CATALOGUE {
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let motion = Sines::two_way(1.0).resting(3.0, 1.0);
        let lighter = |t: f64| motion.under(83.5, t);
        let company = company(info);
        let whole = [company.as_slice(), &[(info.name, &values)]].concat();
        let bare = readings(&chain::<f64>(&company), 0.01, 700, lighter);
        let with = readings(&chain::<f64>(&whole), 0.01, 700, lighter);
        let difference = bare
            .iter()
            .zip(&with)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(difference > 0.01, "{}: {difference} N", info.name);
    }
}
