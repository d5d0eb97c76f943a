//! Tests that a chain created from names and lists of values equals one created from types.
//!
//! Invalid lists are refused with the name of the parameter.

use jbf_catalogue::{Spec, Using};
use jbf_core::effect::coulomb_drag::{self, CoulombDrag};
use jbf_core::effect::sensor_lag::{self, SensorLag};
use jbf_core::effect::{Effect, Rig};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::{Law, Named};
use jbf_core::{Bearing, Chain, Clock, Error, Motion};

/// Load on one bearing, N.
const LOAD_N: f64 = 104.0;

/// Readings of a chain along a motion with reversals.
fn readings<L: Law<f64>, E: Effect<f64>>(chain: &Chain<f64, L, E>) -> Vec<f64> {
    let mut state = chain.start(&Motion::at_rest(LOAD_N));
    (0..300)
        .map(|i| chain.step_velocity(&mut state, 0.1 * (0.02 * f64::from(i)).sin(), 0.01))
        .collect()
}

/// Computes the readings along a motion, and the properties of the rig.
struct Along;

impl Using<f64> for Along {
    type Output = (Vec<f64>, Rig<f64>);

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> Self::Output {
        (readings(&chain), chain.rig)
    }
}

const TABLE_4_2: [f64; 4] = [0.26, 0.06, 7.5e5, 33.0];

fn built(
    law: &str,
    values: &[f64],
    effects: &[(&str, &[f64])],
) -> Result<(Vec<f64>, Rig<f64>), Error> {
    let journal = law == "journal";
    let spec = Spec {
        law,
        values,
        bearing: journal.then_some(&Bearing::THESIS),
        load_n: journal.then_some(LOAD_N),
        clock: Clock::Journal,
    };
    spec.chain(effects.iter().copied(), Along)
}

#[test]
fn chain_from_names_equals_the_chain_from_types() {
    let effects: [(&str, &[f64]); 2] = [("sensor_lag", &[0.1]), ("coulomb_drag", &[0.8])];
    let (named, rig) = built("journal", &TABLE_4_2, &effects).expect("valid");
    let bearing = Bearing::THESIS;
    let law = Journal::new(&bearing, LOAD_N, &Parameters::TABLE_4_2, Clock::Journal);
    let lag = SensorLag::new(sensor_lag::Parameters { tau_s: 0.1 }).expect("valid");
    let drag = CoulombDrag::new(coulomb_drag::Parameters { f_d: 0.8 }).expect("valid");
    let typed = Chain::new(law.expect("valid")).with(lag).with(drag);
    assert_eq!(named, readings(&typed.on(&bearing)));
    assert_eq!((rig.radius_m, rig.count), (0.0127, 4.0));
    // Without a bearing the axis is a linear one.
    let (_, rig) = built("coulomb", &[6.0, 9.0, 40.0], &[]).expect("valid");
    assert_eq!((rig.radius_m, rig.count), (1.0, 1.0));
}

#[test]
fn invalid_part_of_a_specification_is_refused_by_name() {
    let refused = |law: &str, values: &[f64], effects: &[(&str, &[f64])]| {
        built(law, values, effects).expect_err("refused").name()
    };
    assert_eq!(refused("no_such", &TABLE_4_2, &[]), "law");
    assert_eq!(
        refused("journal", &TABLE_4_2, &[("no_such", &[])]),
        "effect"
    );
    assert_eq!(
        refused("journal", &TABLE_4_2, &[("sensor_lag", &[])]),
        "tau_s"
    );
    assert_eq!(refused("coulomb", &[6.0, -1.0, 0.0], &[]), "F_s");
}
