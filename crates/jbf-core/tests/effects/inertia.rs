//! Tests that a force `m_e dv/dt` is added to that of the bearing, also at reversals.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::Sines;
use crate::common::{chain_round, readings, LOAD_N};

#[test]
fn force_is_the_mass_times_the_acceleration() {
    let (f, omega) = (0.1, 3.0);
    let sines = Sines::two_way(omega);
    for mass_kg in [0.9, 4.0, 100.0] {
        let chain = chain_round(ConstantLaw(f), &[("inertia", &[mass_kg])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, r) in got.iter().enumerate() {
            let phase = omega * 0.01 * i as f64;
            let way = if i == 0 { 0.0 } else { phase.sin().signum() };
            let expected = f * LOAD_N * way + mass_kg * 0.127 * omega * phase.cos();
            assert!(
                (r - expected).abs() < 1e-11,
                "{mass_kg} {i}: {r} {expected}"
            );
        }
    }
}
