//! Tests of typed parameters, and of chains built from typed laws and effects.

use jbf_core::effect::gravity::{self, Gravity};
use jbf_core::effect::sensor_lag::{self, SensorLag};
use jbf_core::effect::shear_thinning::{self, ShearThinning};
use jbf_core::effect::Named as NamedEffect;
use jbf_core::law::lugre::{self, LuGre};
use jbf_core::law::{steady_n, Named};
use jbf_core::{Bearing, Chain, Clock, Error, Motion};

const LUGRE: lugre::Parameters<f64> = lugre::Parameters {
    f_c: 4.0,
    f_s: 6.0,
    v_s: 0.01,
    sigma_0: 1e5,
    sigma_1: 100.0,
    v_d: 0.1,
    f_v: 10.0,
};
const _: () = assert!(LUGRE.is_valid());

#[test]
fn typed_law_and_effect_equal_those_built_from_a_list_of_values() {
    let typed = LuGre::new(LUGRE).expect("valid");
    let values = [4.0, 6.0, 0.01, 1e5, 100.0, 0.1, 10.0];
    let named = <LuGre<f64> as Named<f64>>::build(None, None, &values, Clock::Journal);
    assert_eq!(format!("{typed:?}"), format!("{:?}", named.expect("valid")));
    let typed = Gravity::new(gravity::Parameters {
        g: 3.0,
        theta_0_rad: 0.4,
    });
    let named = <Gravity<f64> as NamedEffect<f64>>::build(&[3.0, 0.4]);
    assert_eq!(format!("{typed:?}"), format!("{named:?}"));
}

#[test]
fn parameter_out_of_bounds_is_refused_with_its_name() {
    let too_small = lugre::Parameters { f_s: -1.0, ..LUGRE };
    assert!(!too_small.is_valid());
    assert_eq!(LuGre::new(too_small).expect_err("refused").name(), "F_s");
}

/// An effect that vanishes at infinity must be omitted there.
#[test]
fn infinite_value_without_effect_is_refused_by_constructor_and_validity_check() {
    let usual = shear_thinning::Parameters::<f64>::default();
    assert!(usual.is_valid() && ShearThinning::new(usual).is_ok());
    let without = shear_thinning::Parameters {
        u_c_m_s: f64::INFINITY,
        ..usual
    };
    assert!(!without.is_valid());
    let error = ShearThinning::new(without).expect_err("refused");
    assert_eq!(error.name(), "U_c_m_s");
}

#[test]
fn more_values_than_parameters_are_refused() {
    let too_many = |given, needed| Error::TooMany {
        name: "parameters",
        given,
        needed,
    };
    let effect = <Gravity<f64> as NamedEffect<f64>>::build(&[3.0, 0.4, 0.0]);
    assert_eq!(effect.expect_err("three"), too_many(3, 2));
    for (name, values) in [
        ("coulomb", &[4.0, 6.0, 10.0, 0.0][..]),
        ("journal", &[0.1, 0.1, 1e5, 1.0, 0.0]),
    ] {
        let (bearing, mut out) = (Some(&Bearing::THESIS), [0.0]);
        let error = steady_n(
            name,
            bearing,
            Some(104.0),
            values,
            Clock::Journal,
            &[0.1],
            &mut out,
        );
        let needed = values.len() - 1;
        assert_eq!(error.expect_err(name), too_many(needed + 1, needed));
    }
}

/// The default of an effect has no influence where there is such a value.
#[test]
fn default_parameters_are_valid_and_a_default_effect_vanishes() {
    assert!(lugre::Parameters::<f64>::default().is_valid());
    let weight = gravity::Parameters::<f64>::default();
    assert!(weight.is_valid() && weight.g == 0.0);
    assert_eq!(weight.cast::<f32>(), gravity::Parameters::default());
}

/// A step to a speed equals a step to the motion that follows from a linear change of the speed.
#[test]
fn step_to_a_speed_integrates_the_angle() {
    let chain = Chain::new(LuGre::new(LUGRE).expect("valid"))
        .with(SensorLag::new(sensor_lag::Parameters { tau_s: 0.01 }).expect("valid"))
        .with(
            Gravity::new(gravity::Parameters {
                g: 3.0,
                theta_0_rad: 0.4,
            })
            .expect("valid"),
        )
        .on(&Bearing::THESIS);
    let (mut a, mut b) = (
        chain.start(&Motion::default()),
        chain.start(&Motion::default()),
    );
    let (dt_s, mut motion) = (0.001, Motion::default());
    for i in 1..=500 {
        let velocity_m_s = 0.02 * (0.01 * f64::from(i)).sin();
        let mean_m_s = (motion.velocity_m_s + velocity_m_s) * 0.5;
        motion.time_s += dt_s;
        motion.acceleration_m_s2 = (velocity_m_s - motion.velocity_m_s) / dt_s;
        motion.velocity_m_s = velocity_m_s;
        motion.angle_rad += mean_m_s * dt_s / Bearing::THESIS.radius_m;
        assert_eq!(
            chain.step_velocity(&mut a, velocity_m_s, dt_s),
            chain.step(&mut b, &motion, dt_s)
        );
    }
}
