//! Tests of viscous friction `F_v v / (1 + w |v|)`, which is half of the linear value at `1/w`; dry
//! friction is unchanged.

use crate::common::motion::Sines;
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn viscous_friction_saturates_with_speed_and_dry_friction_is_unchanged() {
    let sines = Sines::two_way(1.0);
    for v_c in [0.01, 0.127, 40.0] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("viscous_thinning", &[1.0 / v_c])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let v = 0.127 * (0.01 * i as f64).sin();
            // Harmonic sum of a straight line and a level.
            let viscous = 1.0 / (1.0 / (F_V_N_S_M * v.abs()) + 1.0 / (F_V_N_S_M * v_c));
            let expected = (F_C_N + viscous) * v.signum();
            assert!((f - expected).abs() < 1e-12, "{v_c} {i}: {f} {expected}");
        }
    }
}
