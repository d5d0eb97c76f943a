//! Tests that a force `c v |v|` is added to that of the bearing, independent of the load.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;
use crate::common::{chain_round, readings, LOAD_N};
use jbf_core::Motion;

#[test]
fn drag_grows_with_the_square_of_the_speed() {
    let f = 0.1;
    for c in [0.7, 50.0, 1e4] {
        let chain = chain_round(ConstantLaw(f), &[("quadratic_drag", &[c])]);
        for speed in [1e-3, 0.02, 0.5, 3.0] {
            for (way, load_n) in [(1.0, LOAD_N), (-1.0, LOAD_N), (1.0, 3.0), (-1.0, 500.0)] {
                let expected = way * (f * load_n + c * speed * speed);
                let motion = |t: f64| Motion {
                    load_n,
                    ..constant(way * speed, t)
                };
                for r in readings(&chain, 0.01, 2, motion) {
                    assert!(
                        (r / expected - 1.0).abs() < 1e-14,
                        "{c} {speed}: {r} {expected}"
                    );
                }
            }
        }
    }
}
