//! Tests that a mirrored motion has the mirrored friction of the mirrored machine.

use crate::common::motion::Sines;
use crate::common::random::Random;
use crate::common::{chain, readings};
use jbf_core::effect::Mirror;
use jbf_core::effect::{Info, CATALOGUE};

/// Parameters of the mirrored machine; the description of a parameter states whether its sign
/// changes.
fn mirrored(info: &Info, values: &[f64]) -> Vec<f64> {
    let turned = info.parameters.iter().zip(values);
    turned
        .map(|(p, &v)| match p.mirror {
            Mirror::Same => v,
            Mirror::Negate => -v,
        })
        .collect()
}

#[test]
fn mirrored_motion_gives_mirrored_friction_with_every_effect() {
    let mut random = Random::new(2);
    for info in CATALOGUE {
        for _ in 0..20 {
            let motion = Sines::random(&mut random);
            let values: Vec<f64> = info
                .parameters
                .iter()
                .map(|p| random.parameter(p))
                .collect();
            let there = chain::<f64>(&[(info.name, &values)]);
            let back = chain::<f64>(&[(info.name, &mirrored(info, &values))]);
            let there = readings(&there, 0.01, 500, |t| motion.at(t));
            let back = readings(&back, 0.01, 500, |t| motion.mirrored().at(t));
            // Sign changes are exact in binary arithmetic, so there is no rounding error.
            for (a, b) in there.iter().zip(&back) {
                assert_eq!(*a, -*b, "{} {values:?}", info.name);
            }
        }
    }
}

/// Without a mirrored theta_0, the friction with a ripple is not odd, so the change of sign is
/// necessary.
#[test]
fn ripple_is_not_odd_unless_its_phase_is_mirrored() {
    let rippled = chain::<f64>(&[("position_ripple", &[0.5, 1.0])]);
    let motion = Sines::two_way(1.0);
    let there = readings(&rippled, 0.01, 200, |t| motion.at(t));
    let back = readings(&rippled, 0.01, 200, |t| motion.mirrored().at(t));
    assert!(there.iter().zip(&back).any(|(a, b)| (a + b).abs() > 1.0));
}
