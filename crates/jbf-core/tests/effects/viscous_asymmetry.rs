//! Tests of viscous friction `F_v v + b |v|`: the slope depends on the direction, and dry friction
//! is unchanged.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn viscous_slope_differs_by_direction() {
    let sines = Sines::two_way(1.0);
    for b in [5.0, -39.0] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("viscous_asymmetry", &[b])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let v = 0.127 * (0.01 * i as f64).sin();
            let slope = if v > 0.0 {
                F_V_N_S_M + b
            } else {
                F_V_N_S_M - b
            };
            let expected = F_C_N * v.signum() + slope * v;
            assert!((f - expected).abs() < 1e-12, "{b} {i}: {f} {expected}");
        }
    }
}
