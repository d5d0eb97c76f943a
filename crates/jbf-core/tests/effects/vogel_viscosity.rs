//! Tests of Vogel's relation against that of ASTM D341 (Walther), and of a warm film against one
//! with thinner oil.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, readings, LOAD_N};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Clock, Motion};

const C_C: f64 = -95.0;
const REFERENCE_C: f64 = 40.0;

/// Factor on the viscosity at a temperature, from a run.
fn factor(b_k: f64, celsius: f64) -> f64 {
    let effect: [(&str, &[f64]); 1] = [("vogel_viscosity", &[b_k, C_C, REFERENCE_C])];
    let chain = chain_round(ConstantLaw(0.1), &effect);
    let at = |t: f64| Motion {
        temperature_c: Some(celsius),
        ..constant::<f64>(0.05, t)
    };
    let mut state = chain.start(&at(0.0));
    chain.step(&mut state, &at(0.01), 0.01);
    state.law / 0.05
}

#[test]
fn viscosity_factor_follows_vogels_equation() {
    for (b, celsius) in [(800.0, 20.0), (800.0, 90.0), (1200.0, -10.0), (0.0, 5.0)] {
        let expected = (b / (celsius - C_C) - b / (REFERENCE_C - C_C)).exp();
        assert!((factor(b, celsius) / expected - 1.0).abs() < 1e-13);
    }
    assert_eq!(factor(900.0, REFERENCE_C), 1.0);
}

/// Vogel's relation agrees with Walther's within 3 %.
///
/// The oil has 46 mm^2/s at 40 C and 6.8 mm^2/s at 100 C. The reference is `log log (nu + 0.7) = A
/// - B log T` (ASTM D341) at temperatures in this range and close to it.
#[test]
fn viscosity_of_a_grade_46_oil_agrees_with_walther_within_3_percent() {
    let walther = |celsius: f64| {
        let double = |nu: f64| (nu + 0.7_f64).log10().log10();
        let place = |c: f64| (c + 273.15_f64).log10();
        let slope = (double(6.8) - double(46.0)) / (place(100.0) - place(40.0));
        let there = double(46.0) + slope * (place(celsius) - place(40.0));
        10.0_f64.powf(10.0_f64.powf(there)) - 0.7
    };
    let b = (6.8_f64 / 46.0).ln() / (1.0 / (100.0 - C_C) - 1.0 / (REFERENCE_C - C_C));
    for celsius in [20.0, 30.0, 50.0, 60.0, 70.0, 80.0, 90.0] {
        let (found, wanted) = (46.0 * factor(b, celsius), walther(celsius));
        assert!(
            (found / wanted - 1.0).abs() < 0.03,
            "{celsius} C: {found} {wanted} mm^2/s"
        );
    }
}

/// The warm film of one oil equals that of a thinner oil.
///
/// The thinner oil has another viscosity and another transition speed with the same product.
#[test]
fn warm_film_equals_that_of_a_thinner_oil() {
    let (b, warm) = (850.0, 63.0);
    let thin = (b / (warm - C_C) - b / (REFERENCE_C - C_C)).exp();
    let table = Parameters::TABLE_4_2;
    let other = Parameters {
        u_tr_m_s: table.u_tr_m_s / thin,
        ..table
    };
    let bearing = Bearing::THESIS.with_viscosity_pa_s(Bearing::THESIS.viscosity_pa_s * thin);
    let law = |bearing: &Bearing, p: &Parameters<f64>| {
        Journal::new(bearing, LOAD_N, p, Clock::Journal).expect("valid")
    };
    let sines = Sines::two_way(1.0);
    let at = |t: f64| -> Motion<f64> {
        Motion {
            temperature_c: Some(warm),
            ..sines.at(t)
        }
    };
    let effect: [(&str, &[f64]); 1] = [("vogel_viscosity", &[b, C_C, REFERENCE_C])];
    let run =
        |law, effects: &[(&str, &[f64])]| readings(&chain_round(law, effects), 0.005, 800, at);
    let with = run(law(&Bearing::THESIS, &table), &effect);
    let own = run(law(&bearing, &other), &[]);
    let bare = run(law(&Bearing::THESIS, &table), &[]);
    for (a, b) in with.iter().zip(&own) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let apart = with.iter().zip(&bare).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) > 1.0);
}
