//! Tests that Coulomb drag adds F_d sgn(v), independent of the load.

use crate::common::motion::Sines;
use crate::common::{chain, readings};
use jbf_core::Motion;

#[test]
fn drag_has_the_sign_of_the_motion_and_does_not_depend_on_the_load() {
    let sines = Sines::two_way(1.0);
    let motion = |t: f64| Motion {
        load_n: 104.0 + 30.0 * (3.0 * t).sin(),
        ..sines.at(t)
    };
    let bare = readings(&chain::<f64>(&[]), 0.01, 700, motion);
    let with = readings(
        &chain::<f64>(&[("coulomb_drag", &[1.7])]),
        0.01,
        700,
        motion,
    );
    for (i, (a, b)) in bare.iter().zip(&with).enumerate() {
        let v = motion(0.01 * i as f64).velocity_m_s;
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        assert!((b - a - 1.7 * sign).abs() < 1e-12, "sample {i}");
    }
}
