//! Tests of dry friction linear in the temperature, `F_c (1 + a (T - T_0))`, with a lower limit of
//! zero.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};
use jbf_core::Motion;

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn dry_level_depends_on_temperature_but_viscous_friction_does_not() {
    let sines = Sines::two_way(1.0);
    for (a, reference) in [(-0.02, 30.0), (0.015, 20.0)] {
        let effect: [(&str, &[f64]); 1] = [("dry_temperature_dependence", &[a, reference])];
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &effect);
        let got = readings(&chain, 0.01, 900, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let v = 0.127 * t.sin();
            let level = F_C_N * (1.0 + a * (31.0 + 6.0 * (0.7 * t).sin() - reference));
            let expected = level * v.signum() + F_V_N_S_M * v;
            assert!((f - expected).abs() < 1e-12, "{a} {i}: {f} {expected}");
        }
    }
}

/// Dry friction is zero, not negative, at temperatures at which the linear function is negative.
#[test]
fn dry_level_is_zero_beyond_the_zero_of_its_line() {
    let effect: [(&str, &[f64]); 1] = [("dry_temperature_dependence", &[-0.02, 20.0])];
    let chain = chain_round(newtons(F_C_N, 0.0), &effect);
    let sines = Sines::two_way(1.0);
    let at = |celsius: f64| {
        let warm = |t: f64| Motion {
            temperature_c: Some(celsius),
            ..sines.at::<f64>(t)
        };
        readings(&chain, 0.01, 100, warm)[100]
    };
    assert!((at(69.0) - 0.02 * F_C_N).abs() < 1e-12, "{}", at(69.0));
    assert_eq!([at(71.0), at(500.0)], [0.0, 0.0]);
}
