//! Tests that readings with any effect are finite for any parameters within the bounds.

use crate::common::motion::Sines;
use crate::common::random::Random;
use crate::common::{chain, readings, LOAD_N};
use jbf_core::effect::CATALOGUE;
use jbf_core::{Motion, Real};

/// Unrealistic motion with jumps of speed, load, angle and temperature.
fn jerk<T: Real>(random: &mut Random, time_s: f64) -> Motion<T> {
    let speed = random.log_uniform(1e-9, 1e3) * if random.chance(0.5) { 1.0 } else { -1.0 };
    Motion {
        time_s: T::of(time_s),
        velocity_m_s: T::of(if random.chance(0.2) { 0.0 } else { speed }),
        acceleration_m_s2: T::of(random.uniform(-1e3, 1e3)),
        angle_rad: T::of(random.uniform(-1e3, 1e3)),
        temperature_c: Some(T::of(random.uniform(-1e3, 2e3))),
        ..Motion::at_rest(T::of(if random.chance(0.1) {
            random.log_uniform(1.0, 1e4)
        } else {
            LOAD_N
        }))
    }
}

fn check<T: Real>(seed: u64) {
    let mut random = Random::new(seed);
    for info in CATALOGUE {
        for _ in 0..40 {
            let values: Vec<f64> = info
                .parameters
                .iter()
                .map(|p| random.parameter(p))
                .collect();
            let effects = [(info.name, values.as_slice())];
            let chain = chain::<T>(&effects);
            let dt_s = random.log_uniform(1e-5, 1.0);
            let motion = Sines::random(&mut random);
            for reading in readings(&chain, dt_s, 400, |t| motion.at(t)) {
                assert!(reading.is_finite(), "{effects:?} dt {dt_s} {motion:?}");
            }
            let mut state = chain.start(&jerk(&mut random, 0.0));
            for i in 1..200 {
                let to = jerk(&mut random, dt_s * f64::from(i));
                let reading = chain.step(&mut state, &to, T::of(dt_s));
                assert!(reading.is_finite(), "{effects:?} dt {dt_s} {to:?}");
            }
        }
    }
}

#[test]
fn every_effect_is_finite_in_double_precision() {
    check::<f64>(3);
}

#[test]
fn every_effect_is_finite_in_single_precision() {
    check::<f32>(4);
}

/// A sample that is not finite and a step of zero length do not change a run.
#[test]
fn invalid_sample_or_step_does_not_change_a_run() {
    for info in CATALOGUE {
        let values: Vec<f64> = info.parameters.iter().map(|p| p.starts[0]).collect();
        let chain = chain::<f64>(&[(info.name, &values)]);
        let sines = Sines::two_way(1.0);
        let whole = readings(&chain, 0.01, 200, |t| sines.at(t));
        let mut state = chain.start(&sines.at(0.0));
        for (i, &expected) in whole.iter().enumerate().skip(1) {
            let to = sines.at::<f64>(0.01 * i as f64);
            let before = state.reading_n;
            let lost = [
                Motion {
                    velocity_m_s: f64::NAN,
                    ..to
                },
                Motion {
                    angle_rad: f64::INFINITY,
                    ..to
                },
                Motion {
                    load_n: f64::NAN,
                    ..to
                },
                Motion {
                    temperature_c: Some(f64::NAN),
                    ..to
                },
            ];
            for motion in &lost {
                assert_eq!(chain.step(&mut state, motion, 0.01), before);
            }
            for dt_s in [0.0, -1.0, 1e-300, f64::NAN] {
                assert_eq!(chain.step(&mut state, &to, dt_s), before);
            }
            assert_eq!(chain.step(&mut state, &to, 0.01), expected, "{}", info.name);
        }
    }
}
