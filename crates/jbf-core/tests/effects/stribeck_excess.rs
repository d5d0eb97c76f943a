//! Tests that friction is higher by `a exp(-(|v|/v_s)^n)` at low speed, equally in both directions.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;
use crate::common::{chain_round, readings, LOAD_N};

#[test]
fn excess_decays_exponentially_with_a_power_of_the_speed() {
    let f = 0.1;
    for v_s in [0.01, 0.3] {
        for n in [0.5, 1.0, 1.5, 2.0, 6.0] {
            let a = 0.05;
            let chain = chain_round(ConstantLaw(f), &[("stribeck_excess", &[a, v_s, n])]);
            for speed in [1e-5, 1e-3, 0.01, 0.02, 0.1, 0.3, 0.5, 2.0] {
                let expected = (f + a * (-(speed / v_s).powf(n)).exp()) * LOAD_N;
                for way in [1.0, -1.0] {
                    let got = readings(&chain, 0.01, 2, |t| constant::<f64>(way * speed, t));
                    for r in got {
                        assert!(
                            (way * r - expected).abs() < 1e-12 * LOAD_N,
                            "v_s {v_s}, n {n}, {speed}: {r} {expected}"
                        );
                    }
                }
            }
        }
    }
}
