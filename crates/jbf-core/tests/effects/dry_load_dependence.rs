//! Tests that a friction level `mu L` is added to that of the law, with a sum of zero or more.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn dry_level_grows_in_proportion_to_the_load() {
    let sines = Sines::two_way(1.0);
    for mu in [0.02, 0.3, -0.04, -0.3] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("dry_load_dependence", &[mu])]);
        let load = |t: f64| 100.0 + 30.0 * (2.0 * t).sin();
        let got = readings(&chain, 0.01, 700, |t| sines.under::<f64>(load(t), t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let v = 0.127 * t.sin();
            let level = (F_C_N + mu * load(t)).max(0.0);
            let expected = level * v.signum() + F_V_N_S_M * v;
            assert!((f - expected).abs() < 1e-12, "{mu} {i}: {f} {expected}");
        }
    }
}
