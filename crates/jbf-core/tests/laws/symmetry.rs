//! Tests that a mirrored motion has the mirrored friction.

use super::support::{along, anywhere, in_newtons};
use crate::common::motion::Sines;
use crate::common::random::Random;

#[test]
fn mirrored_motion_gives_mirrored_friction_with_every_law() {
    let mut random = Random::new(11);
    for law in in_newtons() {
        for _ in 0..30 {
            let motion = Sines::random(&mut random);
            let values = anywhere(law, &mut random);
            let there = along::<f64>(law.name, &values, 0.004, 600, |t| motion.at(t));
            let back = along::<f64>(law.name, &values, 0.004, 600, |t| motion.mirrored().at(t));
            for (a, b) in there.iter().zip(&back) {
                assert_eq!(*a, -*b, "{} {values:?}", law.name);
            }
        }
    }
}
