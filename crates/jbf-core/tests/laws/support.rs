//! Functions that run any law of the catalogue along any motion.

use crate::common::random::Random;
use crate::common::readings;
use jbf_core::effect::{Effects, Rig};
use jbf_core::law::{with_law, Info, Named, Visitor, CATALOGUE};
use jbf_core::{Chain, Clock, Motion, Real};

/// Descriptions of the laws that need no bearing.
pub fn in_newtons() -> impl Iterator<Item = &'static Info> {
    CATALOGUE.iter().filter(|law| !law.needs_bearing)
}

/// Chain of a law and effects on a linear axis, represented by a shaft of radius 1 m.
pub fn axis<T: Real, L>(law: L, effects: Effects<T>) -> Chain<T, L> {
    Chain {
        law,
        effects,
        rig: Rig::default(),
    }
}

struct Along<F> {
    dt_s: f64,
    steps: u32,
    motion: F,
}

impl<T: Real, F: Fn(f64) -> Motion<T>> Visitor<T> for Along<F> {
    type Output = Vec<T>;

    fn visit<L: Named<T>>(self, law: L) -> Vec<T> {
        readings(
            &axis(law, Effects::NONE),
            self.dt_s,
            self.steps,
            self.motion,
        )
    }
}

/// Readings (N) of the law `name`: at the first sample and after each of `steps` steps of `dt_s`.
pub fn along<T: Real>(
    name: &str,
    values: &[T],
    dt_s: f64,
    steps: u32,
    motion: impl Fn(f64) -> Motion<T>,
) -> Vec<T> {
    let visitor = Along {
        dt_s,
        steps,
        motion,
    };
    with_law(name, None, None, values, Clock::Journal, visitor)
        .unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// First start values of the parameters of a law.
pub fn starts(law: &Info) -> Vec<f64> {
    law.parameters.iter().map(|p| p.starts[0]).collect()
}

/// Random values within the bounds of the parameters of a law.
pub fn anywhere(law: &Info, random: &mut Random) -> Vec<f64> {
    law.parameters.iter().map(|p| random.parameter(p)).collect()
}

/// Motion at a time with a speed and a position, under a load of 1 N.
pub fn moving<T: Real>(time_s: f64, velocity_m_s: f64, place_m: f64) -> Motion<T> {
    Motion {
        time_s: T::of(time_s),
        velocity_m_s: T::of(velocity_m_s),
        acceleration_m_s2: T::ZERO,
        angle_rad: T::of(place_m),
        ..Motion::at_rest(T::ONE)
    }
}

/// Sinusoidal position with an amplitude in m, as a function of time.
pub fn sine<T: Real>(amplitude_m: f64, omega_rad_s: f64) -> impl Fn(f64) -> Motion<T> {
    move |t| {
        let (sin, cos) = (omega_rad_s * t).sin_cos();
        moving(t, amplitude_m * omega_rad_s * cos, amplitude_m * sin)
    }
}

/// Largest absolute difference between two signals.
pub fn gap(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.iter().zip(b);
    pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}
