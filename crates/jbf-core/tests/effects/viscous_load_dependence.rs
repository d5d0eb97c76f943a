//! Tests that a force `c L v` is added to the viscous friction of the law.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn viscous_slope_grows_in_proportion_to_the_load() {
    let sines = Sines::two_way(1.0);
    for c in [0.02, 1.5, -0.1] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("viscous_load_dependence", &[c])]);
        let load = |t: f64| 100.0 + 30.0 * (2.0 * t).sin();
        let got = readings(&chain, 0.01, 700, |t| sines.under::<f64>(load(t), t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let v = 0.127 * t.sin();
            let expected = F_C_N * v.signum() + (F_V_N_S_M + c * load(t)) * v;
            assert!((f - expected).abs() < 1e-12, "{c} {i}: {f} {expected}");
        }
    }
}
