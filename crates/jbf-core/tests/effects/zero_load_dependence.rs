//! Tests that a force `k L` is added to friction, independent of the direction and also at rest.

use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings};
use jbf_core::Motion;

const F_C_N: f64 = 6.0;

#[test]
fn force_includes_a_fraction_of_the_load_also_at_rest() {
    let sines = Sines::two_way(1.0);
    for k in [0.01, -0.4] {
        let chain = chain_round(newtons(F_C_N, 0.0), &[("zero_load_dependence", &[k])]);
        let load = |t: f64| 100.0 + 30.0 * (2.0 * t).sin();
        let got = readings(&chain, 0.01, 700, |t| sines.under::<f64>(load(t), t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let expected = F_C_N * t.sin().signum() + k * load(t);
            assert!((f - expected).abs() < 1e-12, "{k} {i}: {f} {expected}");
        }
        for r in readings(&chain, 0.01, 5, |t| Motion {
            load_n: 50.0,
            ..constant::<f64>(0.0, t)
        }) {
            assert!((r - 50.0 * k).abs() < 1e-12);
        }
    }
}
