//! Tests of user-defined effects at each stage that allows them.
//!
//! They act like the effects of the catalogue at the same stage. A chain with a typed set of
//! effects equals one with the same effects of the catalogue.

mod common;

use common::motion::Sines;
use common::{law, readings};
use jbf_core::effect::coulomb_drag::CoulombDrag;
use jbf_core::effect::direction_asymmetry::DirectionAsymmetry;
use jbf_core::effect::drive_compliance::DriveCompliance;
use jbf_core::effect::film_memory::FilmMemory;
use jbf_core::effect::load_dependence::LoadDependence;
use jbf_core::effect::presliding::{self, Presliding};
use jbf_core::effect::sensor_lag::SensorLag;
use jbf_core::effect::thermal_thinning::ThermalThinning;
use jbf_core::effect::{Effect, Effects, Named, Rig};
use jbf_core::{Bearing, Chain, Clock, Motion};

type Drive = DriveCompliance<f64>;
type Oil = ThermalThinning<f64>;
type Load = LoadDependence<f64>;
type Film = FilmMemory<f64>;
type Contact = DirectionAsymmetry<f64>;
type Bristle = Presliding<f64>;
type Other = CoulombDrag<f64>;
type Instrument = SensorLag<f64>;

/// Readings, and the force on the commanded side, under an oscillating load.
fn run(effects: impl Effect<f64>) -> Vec<f64> {
    let rig = Rig {
        radius_m: Bearing::THESIS.radius_m,
        count: 4.0,
        force_at_drive: false,
    };
    let chain = Chain {
        law: law(Clock::Journal),
        effects,
        rig,
    };
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let motion = |t: f64| Motion {
        load_n: 100.0 + 20.0 * (0.7 * t).sin(),
        ..sines.at(t)
    };
    let mut state = chain.start(&motion(0.0));
    let mut out = vec![state.reading_n];
    for i in 1..=700 {
        out.push(chain.step(&mut state, &motion(0.01 * f64::from(i)), 0.01));
        let reaction_n = chain.reaction_n(&state);
        out.extend([reaction_n.jump, reaction_n.smooth]);
    }
    out
}

/// Name of an effect, and start values of its parameters.
fn page<P: Named<f64>>() -> (&'static str, Vec<f64>) {
    let values = P::INFO.parameters.iter().map(|p| p.starts[0]);
    (P::INFO.name, values.collect())
}

fn typed<P: Named<f64>>() -> P {
    P::build(&page::<P>().1).expect("starting values are valid")
}

fn catalogue(list: &[(&str, Vec<f64>)]) -> Vec<f64> {
    let mut effects = Effects::NONE;
    for (name, values) in list {
        effects.set(name, values).expect("valid");
    }
    run(effects)
}

fn acts_alike<P: Named<f64>>() {
    let named = catalogue(&[page::<P>()]);
    assert_eq!(run(typed::<P>()), named, "{} alone", P::INFO.name);
    let beside = (Effects::NONE, typed::<P>());
    assert_eq!(run(beside), named, "{} beside none", P::INFO.name);
    assert_eq!(run(Some(typed::<P>())), named, "{} there", P::INFO.name);
    assert_ne!(named, run(()), "{} does something", P::INFO.name);
}

#[test]
fn user_effect_equals_the_catalogue_effect_at_every_stage() {
    acts_alike::<Drive>();
    acts_alike::<Oil>();
    acts_alike::<Load>();
    acts_alike::<Film>();
    acts_alike::<Contact>();
    acts_alike::<Bristle>();
    acts_alike::<Other>();
    acts_alike::<Instrument>();
}

/// Effects of different stages act in the order of the chain, regardless of the order in which they
/// are combined.
#[test]
fn order_of_user_effects_does_not_change_the_readings() {
    let named = catalogue(&[
        page::<Drive>(),
        page::<Oil>(),
        page::<Load>(),
        page::<Film>(),
        page::<Contact>(),
        page::<Bristle>(),
        page::<Other>(),
        page::<Instrument>(),
    ]);
    let front = (typed::<Drive>(), (typed::<Oil>(), typed::<Load>()));
    let middle = (typed::<Film>(), (typed::<Contact>(), typed::<Bristle>()));
    let back = (typed::<Other>(), typed::<Instrument>());
    assert_eq!(run((front, (middle, back))), named);
    assert_eq!(run((back, (middle, front))), named);
    let mut half = Effects::NONE;
    for (name, values) in [page::<Oil>(), page::<Contact>(), page::<Instrument>()] {
        half.set(name, &values).expect("valid");
    }
    let rest = (
        (typed::<Drive>(), typed::<Load>()),
        (typed::<Film>(), (typed::<Bristle>(), typed::<Other>())),
    );
    assert_eq!(run((half, rest)), named);
}

#[test]
fn empty_set_of_user_effects_changes_no_bit() {
    assert_eq!(run(()), run(Effects::NONE));
    assert_eq!(run((Effects::NONE, ())), run(()));
    assert_eq!(run(None::<Other>), run(()));
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let bare = readings(&common::chain::<f64>(&[]), 0.01, 700, |t| sines.at(t));
    let rig = Rig {
        radius_m: Bearing::THESIS.radius_m,
        count: 4.0,
        force_at_drive: false,
    };
    let chain = Chain {
        law: law(Clock::Journal),
        effects: (),
        rig,
    };
    let mut state = chain.start(&sines.at(0.0));
    for (i, &n) in bare.iter().enumerate().skip(1) {
        assert_eq!(chain.step(&mut state, &sines.at(0.01 * i as f64), 0.01), n);
    }
}

/// A user-defined effect with a parameter at an infinite null value is refused; it must be omitted.
#[test]
fn effect_at_an_infinite_null_is_refused() {
    let error = Bristle::new(presliding::Parameters {
        sigma: f64::INFINITY,
    })
    .expect_err("vanishes");
    assert_eq!(error.name(), "sigma");
    assert!(Bristle::new(presliding::Parameters { sigma: -1.0 }).is_err());
    assert!(<Bristle as Named<f64>>::build(&[]).is_err());
}

/// The longest step of a typed set is the shortest one of its effects.
#[test]
fn longest_step_of_a_set_is_the_shortest_of_its_effects() {
    let set = (typed::<Other>(), typed::<Drive>());
    assert_eq!(Effect::<f64>::longest_step_s(&set), 0.005);
    assert_eq!(Effect::<f64>::longest_step_s(&()), f64::INFINITY);
}
