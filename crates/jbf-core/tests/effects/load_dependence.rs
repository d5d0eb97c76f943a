//! Tests of U_tr and K0 as powers of the load: the tables of Cohn (1998), and the equivalent law
//! with other parameters.

use crate::common::motion::Sines;
use crate::common::{chain_round, readings, LOAD_N};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock};

/// The law for 104 N (Table 4.2 of Cohn 1998) becomes that for 83.5 N (Table 4.3) if the exponents
/// are those between the two tables.
///
/// Both time scales are tested, with and without the inertia of the journal.
#[test]
fn exponents_of_two_tables_convert_the_law_of_one_load_to_the_other() {
    let share: f64 = 83.5 / LOAD_N;
    let exponent = |from: f64, to: f64| (to / from).ln() / share.ln();
    let from = Parameters::TABLE_4_2;
    let to = Parameters {
        u_tr_m_s: 0.05,
        k0: 6.25e5,
        ..from
    };
    let powers = [
        exponent(from.u_tr_m_s, to.u_tr_m_s),
        exponent(from.k0, to.k0),
    ];
    let effects: [(&str, &[f64]); 1] = [("load_dependence", &powers)];
    let sines = Sines::two_way(1.0);
    let motion = |t: f64| sines.under::<f64>(83.5, t);
    for clock in [Clock::Journal, Clock::Thesis] {
        let [law, own] = [(LOAD_N, from), (83.5, to)]
            .map(|(n, p)| Journal::new(&Bearing::THESIS, n, &p, clock).expect("valid"));
        let with = readings(&chain_round(law, &effects), 0.005, 800, motion);
        let bare = readings(&chain_round(law, &[]), 0.005, 800, motion);
        let wanted = readings(&chain_round(own, &[]), 0.005, 800, motion);
        let gap = |a: &[f64]| {
            let pairs = a.iter().zip(&wanted);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        assert!(gap(&with) < 1e-9, "{clock:?} {}", gap(&with));
        assert!(gap(&bare) > 0.5, "{clock:?} {}", gap(&bare));
        let [law, own] = [(LOAD_N, from), (83.5, to)]
            .map(|(n, p)| JournalFull::new(&Bearing::THESIS, n, &p, clock).expect("valid"));
        let with = readings(&chain_round(law, &effects), 0.005, 800, motion);
        let wanted = readings(&chain_round(own, &[]), 0.005, 800, motion);
        for (a, b) in with.iter().zip(&wanted) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
    }
}

/// The exponents have no influence at the nominal load of the rig.
#[test]
fn exponents_have_no_influence_at_the_load_of_the_rig() {
    let law = Journal::new(
        &Bearing::THESIS,
        LOAD_N,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )
    .expect("valid");
    let sines = Sines::two_way(1.0);
    let bare = readings(&chain_round(law, &[]), 0.01, 700, |t| sines.at::<f64>(t));
    let chain = chain_round(law, &[("load_dependence", &[2.3, -1.7])]);
    assert_eq!(bare, readings(&chain, 0.01, 700, |t| sines.at::<f64>(t)));
}
