//! Tests of constructors: errors with parameter, value and rule.

mod common;

use jbf_core::effect::{Effects, CATALOGUE};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Chain, Clock, Error, Motion};

fn build(bearing: Bearing, load_n: f64, p: Parameters<f64>) -> Result<(), Error> {
    Journal::new(&bearing, load_n, &p, Clock::Journal).map(|_| ())
}

#[test]
fn invalid_size_of_a_bearing_is_refused_by_name() {
    let good = Bearing::THESIS;
    for (bearing, name) in [
        (good.with_radius_m(0.0), "radius_m"),
        (good.with_length_m(-1.0), "length_m"),
        (good.with_clearance_m(f64::NAN), "clearance_m"),
        (good.with_clearance_m(0.02), "clearance_m"),
        (good.with_mass_kg(f64::INFINITY), "mass_kg"),
        (good.with_viscosity_pa_s(0.0), "viscosity_pa_s"),
        (good.with_count(0), "count"),
        // Each value is finite, but the combination overflows.
        (good.with_length_m(1e-200), "load_number"),
    ] {
        let error = build(bearing, 104.0, Parameters::TABLE_4_2).expect_err(name);
        assert_eq!(error.name(), name, "{error}");
    }
}

/// In single precision the viscous coefficient overflows before the load number underflows.
#[test]
fn friction_of_a_law_with_a_tiny_load_is_finite_or_the_load_is_refused() {
    for exponent in 20..46 {
        let load_n = 10.0_f64.powi(-exponent);
        let built = Journal::<f32>::new(
            &Bearing::THESIS,
            load_n,
            &common::table_4_2(),
            Clock::Journal,
        );
        let Ok(law) = built else { continue };
        let chain = Chain::new(law).on(&Bearing::THESIS);
        let reading_n = chain.start(&Motion::at_rest(0.0)).reading_n;
        assert!(reading_n.is_finite(), "{load_n} N: {reading_n}");
    }
}

/// A representable load is refused if its load number underflows.
#[test]
fn load_whose_load_number_underflows_is_refused_by_name() {
    for load_n in [1e-39, 1e-310] {
        let error = build(Bearing::THESIS, load_n, Parameters::TABLE_4_2);
        let single = Journal::<f32>::new(
            &Bearing::THESIS,
            load_n,
            &common::table_4_2(),
            Clock::Journal,
        );
        assert_eq!(single.expect_err("too small").name(), "load_number");
        assert_eq!(error.is_err(), load_n < 1e-300);
    }
}

#[test]
fn invalid_parameter_of_the_journal_law_is_refused_by_name() {
    let good = Parameters::TABLE_4_2;
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        for (load_n, p, name) in [
            (bad, good, "load_n"),
            (104.0, Parameters { f_m: bad, ..good }, "f_m"),
            (
                104.0,
                Parameters {
                    u_tr_m_s: bad,
                    ..good
                },
                "U_tr_m_s",
            ),
            (104.0, Parameters { k0: bad, ..good }, "K0"),
            (104.0, Parameters { gamma: bad, ..good }, "gamma"),
        ] {
            let error = build(Bearing::THESIS, load_n, p).expect_err(name);
            assert_eq!(error.name(), name, "{error}");
            assert!(error.to_string().contains("must be"), "{error}");
        }
    }
    // A bearing without asperity friction or without viscous friction is valid.
    assert!(build(
        Bearing::THESIS,
        104.0,
        Parameters {
            f_m: 0.0,
            gamma: 0.0,
            ..good
        }
    )
    .is_ok());
}

#[test]
fn invalid_or_missing_parameter_of_an_effect_is_refused_by_name() {
    for info in CATALOGUE {
        let good: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        assert!(
            Effects::NONE.clone().set(info.name, &good).is_ok(),
            "{}",
            info.name
        );
        for (i, p) in info.parameters.iter().enumerate() {
            for bad in [p.lower - 1.0, p.upper + p.upper.abs() + 1.0, f64::NAN] {
                let mut values = good.clone();
                values[i] = bad;
                let error = Effects::NONE
                    .clone()
                    .set(info.name, &values)
                    .expect_err(info.name);
                assert_eq!(error.name(), p.name);
            }
            let error = Effects::NONE
                .clone()
                .set(info.name, &good[..i])
                .expect_err("too few");
            assert_eq!(error.name(), p.name, "the first missing one");
        }
    }
    let error = Effects::<f64>::NONE
        .clone()
        .set("gremlins", &[])
        .expect_err("unknown");
    assert_eq!(error, Error::UnknownEffect);
}

#[test]
fn transition_eccentricity_outside_the_bearing_is_refused() {
    for bad in [0.0, 1.0, -0.5, f64::NAN] {
        let error = common::law::<f64>(Clock::Journal)
            .with_eps_tr(bad)
            .expect_err("outside");
        assert_eq!(error.name(), "eps_tr");
    }
}
