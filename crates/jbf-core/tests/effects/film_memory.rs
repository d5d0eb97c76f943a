//! Tests that a film whose dynamics are faster by `factor` has the friction of the unchanged film
//! in a motion slower by this factor.

use crate::common::motion::Sines;
use crate::common::{chain, readings};
use jbf_core::Motion;

#[test]
fn faster_film_has_the_friction_of_a_slower_motion() {
    let sines = Sines::two_way(1.0).resting(3.0, 1.0);
    let dt = 2e-3;
    for factor in [0.3, 0.5, 2.0, 2.7] {
        let with = chain::<f64>(&[("film_memory", &[factor])]);
        let got = readings(&with, dt, 3000, |t| sines.at(t));
        let slow = readings(&chain::<f64>(&[]), factor * dt, 3000, |t| Motion {
            time_s: t,
            ..sines.at(dt * (t / (factor * dt)).round())
        });
        let bare = readings(&chain::<f64>(&[]), dt, 3000, |t| sines.at(t));
        let gap = |a: &[f64]| {
            let pairs = a.iter().zip(&slow);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        assert!(gap(&got) < 1e-9, "{factor}: {}", gap(&got));
        assert!(gap(&bare) > 0.1, "{factor}: {}", gap(&bare));
    }
}

/// The steady friction does not depend on the rate of the film dynamics.
#[test]
fn steady_friction_does_not_depend_on_the_rate_of_the_film() {
    let speed = |t: f64| crate::common::motion::constant::<f64>(0.05, t);
    let end = |effects: &[(&str, &[f64])]| readings(&chain(effects), 0.01, 20_000, speed)[20_000];
    let bare = end(&[]);
    for factor in [0.5, 2.0] {
        assert!((end(&[("film_memory", &[factor])]) - bare).abs() < 1e-9);
    }
}
