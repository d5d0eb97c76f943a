//! Tests that the friction of any law is finite for any parameters within the bounds.
//!
//! A value outside the bounds is refused with the name of its parameter.

use super::support::{along, anywhere, in_newtons, moving, starts};
use crate::common::motion::Sines;
use crate::common::random::Random;
use jbf_core::effect::Parameter;
use jbf_core::law::{steady_n, with_law, Named, Visitor, CATALOGUE};
use jbf_core::{Clock, Dual, Motion, Real};
use std::cell::RefCell;

/// Unrealistic motion with jumps of speed and position.
fn jerk<T: Real>(random: &mut Random, time_s: f64) -> Motion<T> {
    let speed = random.log_uniform(1e-9, 1e3) * if random.chance(0.5) { 1.0 } else { -1.0 };
    Motion {
        time_s: T::of(time_s),
        velocity_m_s: T::of(if random.chance(0.2) { 0.0 } else { speed }),
        acceleration_m_s2: T::of(random.uniform(-1e3, 1e3)),
        angle_rad: T::of(random.uniform(-1e3, 1e3)),
        ..Motion::at_rest(T::ONE)
    }
}

fn check<T: Real>(seed: u64, lift: impl Fn(usize, f64) -> T, slopes: impl Fn(T) -> bool) {
    let mut random = Random::new(seed);
    for law in in_newtons() {
        for _ in 0..150 {
            let values = anywhere(law, &mut random);
            let lifted: Vec<T> = values
                .iter()
                .enumerate()
                .map(|(i, &v)| lift(i, v))
                .collect();
            let dt_s = random.log_uniform(1e-5, 1.0);
            let motion = Sines::random(&mut random);
            let smooth = along(law.name, &lifted, dt_s, 300, |t| motion.at(t));
            let shared = RefCell::new(&mut random);
            let jerky = along(law.name, &lifted, dt_s, 300, |t| {
                jerk(*shared.borrow_mut(), t)
            });
            for f in smooth.iter().chain(&jerky) {
                assert!(
                    f.is_finite() && slopes(*f),
                    "{} {values:?} dt {dt_s}: {f:?}",
                    law.name
                );
            }
        }
    }
}

#[test]
fn every_law_is_finite_in_double_precision() {
    check::<f64>(21, |_, v| v, |_| true);
}

#[test]
fn every_law_is_finite_in_single_precision() {
    check::<f32>(22, |_, v| v as f32, |_| true);
}

#[test]
fn every_law_has_finite_derivatives() {
    check::<Dual<8>>(
        23,
        |i, v| Dual::parameter(v, i),
        |f| f.slope.iter().all(|s| s.is_finite()),
    );
}

/// The friction of every law is finite for distances and speeds whose products with the parameters
/// round to zero.
#[test]
fn every_law_is_finite_at_subnormal_speeds() {
    for law in in_newtons() {
        for soft in [false, true] {
            let value = |p: &Parameter| {
                if soft && p.unit == "N/m" {
                    p.lower
                } else {
                    p.starts[0]
                }
            };
            let values: Vec<f64> = law.parameters.iter().map(value).collect();
            let tiny = [1e-315, 1e-315, -1e-310, 3e-308, 0.0, 1e-300, -5e-324];
            let creep = |t: f64| moving(t, tiny[(t * 1e6) as usize % tiny.len()], 0.0);
            for f in along::<f64>(law.name, &values, 1e-6, 60, creep) {
                assert!(f.is_finite(), "{} {values:?}", law.name);
            }
        }
    }
}

struct Nothing;

impl Visitor<f64> for Nothing {
    type Output = ();
    fn visit<L: Named<f64>>(self, _law: L) {}
}

fn refused(name: &str, values: &[f64]) -> String {
    with_law(name, None, None, values, Clock::Journal, Nothing)
        .expect_err("refused")
        .to_string()
}

#[test]
fn invalid_parameter_of_a_law_is_refused_by_name() {
    for law in in_newtons() {
        for (i, p) in law.parameters.iter().enumerate() {
            for bad in [f64::NAN, f64::INFINITY, -1.0, 2.0 * p.upper] {
                let mut values = starts(law);
                values[i] = bad;
                let error = refused(law.name, &values);
                assert!(error.starts_with(p.name), "{}: {error}", law.name);
            }
        }
        let error = refused(law.name, &[]);
        assert!(error.starts_with(law.parameters[0].name), "{error}");
    }
    assert!(refused("nolaw", &[]).starts_with("law"));
    assert!(refused("journal", &[0.25, 0.05, 6e5, 33.0]).starts_with("bearing"));
    assert!(refused("journal", &[]).starts_with("parameters"));
}

#[test]
fn steady_curve_at_rest_is_refused() {
    for law in in_newtons() {
        for bad in [0.0, f64::NAN, f64::INFINITY] {
            let mut out = [0.0];
            let values = starts(law);
            let error = steady_n(
                law.name,
                None,
                None,
                &values,
                Clock::Journal,
                &[bad],
                &mut out,
            )
            .expect_err("refused");
            assert_eq!(error.name(), "velocity_m_s");
        }
    }
}

#[test]
fn laws_of_the_catalogue_have_unique_names_and_valid_starts() {
    let names: Vec<_> = CATALOGUE.iter().map(|law| law.name).collect();
    assert_eq!(names[0], "journal", "the default stands first");
    for law in CATALOGUE {
        assert_eq!(names.iter().filter(|n| **n == law.name).count(), 1);
        for p in law.parameters {
            assert!(
                p.lower < p.upper && !p.starts.is_empty(),
                "{}.{}",
                law.name,
                p.name
            );
            assert!(p.starts.iter().all(|s| (p.lower..=p.upper).contains(s)));
            assert!(!p.log || p.lower > 0.0, "{}.{}", law.name, p.name);
        }
    }
}
