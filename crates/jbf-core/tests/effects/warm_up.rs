//! Tests of warm-up: friction multiplied by `1 + a exp(-t/tau)`, in motion and at rest.

use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings};

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;

#[test]
fn friction_decays_exponentially_with_time() {
    let sines = Sines::two_way(1.0);
    for (a, tau) in [(0.3, 2.0), (-0.5, 40.0)] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("warm_up", &[a, tau])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let v = 0.127 * t.sin();
            let plain = F_C_N * v.signum() + F_V_N_S_M * v;
            let expected = plain * (1.0 + a * (-t / tau).exp());
            assert!((f - expected).abs() < 1e-10, "{a} {i}: {f} {expected}");
        }
    }
}

/// Friction also decays at rest, in contrast to running-in, which depends on the sliding distance.
#[test]
fn friction_decays_also_during_a_rest() {
    let chain = chain_round(newtons(F_C_N, 0.0), &[("warm_up", &[0.5, 3.0])]);
    let later = |t: f64| constant::<f64>(if t < 5.0 { 0.0 } else { 0.05 }, t);
    let last = readings(&chain, 0.01, 600, later)[600];
    assert!(
        (last - F_C_N * (1.0 + 0.5 * (-2.0_f64).exp())).abs() < 1e-10,
        "{last}"
    );
}
