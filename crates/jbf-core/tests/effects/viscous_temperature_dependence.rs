//! Tests of viscous friction with Vogel's relation, `F_v exp(B/(T - C) - B/(T_0 - C))`.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn viscous_slope_depends_on_temperature_but_the_dry_level_does_not() {
    let sines = Sines::two_way(1.0);
    for [b, c, reference] in [[700.0, -95.0, 20.0], [-300.0, -110.0, 30.0]] {
        let effect: [(&str, &[f64]); 1] = [("viscous_temperature_dependence", &[b, c, reference])];
        let chain = chain_round(newtons(F_C_N, F_V_N_S_M), &effect);
        let got = readings(&chain, 0.01, 900, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let v = 0.127 * t.sin();
            let warm = 31.0 + 6.0 * (0.7 * t).sin();
            let viscosity = (b / (warm - c)).exp() / (b / (reference - c)).exp();
            let expected = F_C_N * v.signum() + F_V_N_S_M * viscosity * v;
            assert!((f - expected).abs() < 1e-12, "{b} {i}: {f} {expected}");
        }
    }
}
