//! Tests that the dry and viscous friction of the contact are multiplied by `1 + a sgn v`.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn dry_and_viscous_friction_are_scaled_by_the_direction() {
    let law = newtons(F_C_N, F_V_N_S_M);
    let sines = Sines::two_way(1.0);
    for a in [0.05, -0.4, 0.9] {
        let chain = chain_round(law, &[("direction_asymmetry", &[a])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let v = 0.127 * (0.01 * i as f64).sin();
            let expected = (F_C_N * v.signum() + F_V_N_S_M * v) * (1.0 + a * v.signum());
            assert!((f - expected).abs() < 1e-12, "{a} {i}: {f} {expected}");
        }
    }
}
