//! Tests that a chain created from names and lists of values equals one created from types.
//!
//! Invalid lists are refused with the name of the parameter.

mod common;

use common::motion::Sines;
use common::{chain_round, law, readings, LOAD_N};
use jbf_core::effect::Rig;
use jbf_core::law::Named;
use jbf_core::spec::{Spec, Using};
use jbf_core::{Bearing, Chain, Clock, ParameterError};

/// Computes the readings along a motion, and the properties of the rig.
struct Along;

impl Using<f64> for Along {
    type Output = (Vec<f64>, Rig<f64>);

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> Self::Output {
        let sines = Sines::two_way(1.0);
        (readings(&chain, 0.01, 300, |t| sines.at(t)), chain.rig)
    }
}

const TABLE_4_2: [f64; 4] = [0.26, 0.06, 7.5e5, 33.0];

fn built(
    law: &str,
    values: &[f64],
    effects: &[(&str, &[f64])],
) -> Result<(Vec<f64>, Rig<f64>), ParameterError> {
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
    let sines = Sines::two_way(1.0);
    let by_hand = chain_round(law::<f64>(Clock::Journal), &effects);
    assert_eq!(named, readings(&by_hand, 0.01, 300, |t| sines.at(t)));
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
