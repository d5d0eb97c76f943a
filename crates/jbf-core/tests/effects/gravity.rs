//! Tests of a weight on the shaft: a force `G sin(theta - theta_0)`, in motion and at rest.

use crate::common::motion::{constant, Sines};
use crate::common::{chain_round, newtons, readings};
use jbf_core::Motion;

const F_C_N: f64 = 6.0;

#[test]
fn weight_is_proportional_to_the_sine_of_the_angle() {
    let sines = Sines::two_way(1.0);
    for (g, theta_0) in [(3.0, 0.4), (110.0, -2.0)] {
        let chain = chain_round(newtons(F_C_N, 0.0), &[("gravity", &[g, theta_0])]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let theta = 10.0 * (1.0 - t.cos());
            let expected = F_C_N * t.sin().signum() + g * (theta - theta_0).sin();
            assert!((f - expected).abs() < 1e-10, "{g} {i}: {f} {expected}");
        }
        let held = |t: f64| Motion {
            angle_rad: 1.1,
            ..constant::<f64>(0.0, t)
        };
        for r in readings(&chain, 0.01, 5, held) {
            assert!((r - g * (1.1_f64 - theta_0).sin()).abs() < 1e-12);
        }
    }
}

/// The weight of a joint that follows another joint depends on the sum of both angles.
#[test]
fn weight_behind_another_joint_depends_on_the_sum_of_both_angles() {
    let sines = Sines::two_way(1.0);
    let other = |t: f64| 0.8 * (0.3 * t).sin();
    for drive in [&[][..], &[("backlash", &[1e-12_f64][..])]] {
        let effects: Vec<_> = [("gravity", &[3.0, 0.4][..])]
            .into_iter()
            .chain(drive.iter().copied())
            .collect();
        let chain = chain_round(newtons(F_C_N, 0.0), &effects);
        let got = readings(&chain, 0.01, 700, |t| Motion {
            weight_offset_rad: other(t),
            ..sines.at::<f64>(t)
        });
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let theta = 10.0 * (1.0 - t.cos()) + other(t);
            let expected = F_C_N * t.sin().signum() + 3.0 * (theta - 0.4).sin();
            assert!((f - expected).abs() < 1e-7, "{i}: {f} {expected}");
        }
    }
}
