//! Tests that the reading is the force plus a constant, from the first sample on and also at rest.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::Sines;
use crate::common::{chain_round, readings, LOAD_N};

#[test]
fn offset_is_added_to_every_reading() {
    let f = 0.1;
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    for b in [0.3, -7.0] {
        let chain = chain_round(ConstantLaw(f), &[("sensor_offset", &[b])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, r) in got.iter().enumerate() {
            let v = sines.at::<f64>(0.01 * i as f64).velocity_m_s;
            let way = if v == 0.0 { 0.0 } else { v.signum() };
            assert!(
                (r - (f * LOAD_N * way + b)).abs() < 1e-14 * LOAD_N,
                "{b} {i}: {r}"
            );
        }
    }
}
