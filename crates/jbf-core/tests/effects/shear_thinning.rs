//! Tests that the effective speed of the film is `U / (1 + (|U|/U_c)^n)`, which is half the speed
//! at U_c for every n.

use crate::common::chain_round;
use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;

/// Effective speed of the film at the speed of the journal, m/s.
fn felt(u_c: f64, n: f64, speed: f64) -> f64 {
    let chain = chain_round(ConstantLaw(0.1), &[("shear_thinning", &[u_c, n])]);
    let mut state = chain.start(&constant(speed, 0.0));
    chain.step(&mut state, &constant(speed, 0.01), 0.01);
    state.law
}

#[test]
fn effective_speed_follows_the_curve_of_cross() {
    for u_c in [0.02, 0.12, 3.0] {
        for n in [0.3, 1.0, 1.2, 4.0] {
            assert!((felt(u_c, n, u_c) / u_c - 0.5).abs() < 1e-15);
            for speed in [1e-3, 0.01, 0.05, 0.4, 2.0] {
                let expected = speed / (1.0 + (speed / u_c).powf(n));
                for way in [1.0, -1.0] {
                    let got = felt(u_c, n, way * speed);
                    assert!(
                        (got / expected - 1.0).abs() < 1e-13,
                        "U_c {u_c}, n {n}, {speed}: {got} {expected}"
                    );
                }
            }
        }
    }
}
