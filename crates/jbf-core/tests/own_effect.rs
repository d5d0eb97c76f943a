//! Effects from outside the crate, in each place that takes them, against the catalogue's own in
//! the same place: an effect does not act otherwise for being somebody else's.

mod common;

use common::motion::Sines;
use common::{law, readings};
use jbf_core::effect::coulomb_drag::CoulombDrag;
use jbf_core::effect::direction_asymmetry::DirectionAsymmetry;
use jbf_core::effect::own::{Beside, InContact, InInstrument, Own};
use jbf_core::effect::sensor_lag::SensorLag;
use jbf_core::effect::{Effect, Effects, Rig};
use jbf_core::{Bearing, Chain, Clock};

fn run<O: Own<f64>>(effects: Effects<f64, O>) -> Vec<f64> {
    let rig = Rig {
        radius_m: Bearing::THESIS.radius_m,
        count: 4.0,
    };
    let chain = Chain {
        law: law(Clock::Journal),
        effects,
        rig,
    };
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let mut state = chain.start(&sines.at(0.0));
    let mut out = vec![state.reading_n];
    out.extend((1..=700).map(|i| chain.step(&mut state, &sines.at(0.01 * f64::from(i)), 0.01)));
    out
}

fn catalogue(list: &[(&str, f64)]) -> Vec<f64> {
    let mut effects = Effects::NONE;
    for (name, value) in list {
        effects.set(name, &[*value]).expect("valid");
    }
    run(effects)
}

#[test]
fn an_effect_acts_alike_from_outside() {
    let drag = Beside(CoulombDrag::new(&[1.3]).expect("valid"));
    let uneven = InContact(DirectionAsymmetry::new(&[0.2]).expect("valid"));
    let lag = InInstrument(SensorLag::new(&[0.1]).expect("valid"));
    let none = Effects::<f64>::NONE;
    assert_eq!(run(none.with(drag)), catalogue(&[("coulomb_drag", 1.3)]));
    assert_eq!(
        run(none.with(uneven)),
        catalogue(&[("direction_asymmetry", 0.2)])
    );
    assert_eq!(run(none.with(lag)), catalogue(&[("sensor_lag", 0.1)]));
    let all = catalogue(&[
        ("coulomb_drag", 1.3),
        ("direction_asymmetry", 0.2),
        ("sensor_lag", 0.1),
    ]);
    assert_eq!(run(none.with((drag, (uneven, lag)))), all);
    assert_ne!(all, catalogue(&[]));
}

#[test]
fn nothing_of_ones_own_changes_nothing() {
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let bare = readings(&common::chain::<f64>(&[]), 0.01, 700, |t| sines.at(t));
    assert_eq!(bare, catalogue(&[]));
}
