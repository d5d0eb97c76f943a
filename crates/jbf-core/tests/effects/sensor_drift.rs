//! Tests that the reading is the force plus a linear function of time, which is zero at the start
//! of the run.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::Sines;
use crate::common::{chain_round, readings, LOAD_N};

#[test]
fn drift_is_linear_in_time() {
    let f = 0.1;
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    for d in [0.005, -2.0] {
        for dt in [0.01, 0.3] {
            let chain = chain_round(ConstantLaw(f), &[("sensor_drift", &[d])]);
            let got = readings(&chain, dt, 700, |t| sines.at::<f64>(t));
            for (i, r) in got.iter().enumerate() {
                let t = dt * i as f64;
                let v = sines.at::<f64>(t).velocity_m_s;
                let way = if v == 0.0 { 0.0 } else { v.signum() };
                let expected = f * LOAD_N * way + d * t;
                assert!((r - expected).abs() < 1e-11, "{d} {t}: {r} {expected}");
            }
        }
    }
}
