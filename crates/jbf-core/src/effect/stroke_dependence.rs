//! Dry friction that varies smoothly along the stroke: dry friction multiplied by `1 + s(x)`.
//!
//! Examples are a screw with more preload in its middle, a guide that is not straight, and a rod
//! with local wear. The contact pressure, and with it the dry friction, varies slowly with the
//! position. Periodic variation is described by `pitch_ripple`.
//!
//! With `u` from -1 to 1 over the stroke, `s` is the sum of the first six waves whose slope
//! vanishes at both ends: `sin(k pi u/2)` for odd and `cos(k pi u/2)` for even `k`. Each wave has
//! zero mean over the stroke, and the waves are orthogonal to each other and to the dry friction.
//! Beyond the ends, friction is constant.
//!
//! A fit places the ends slightly beyond the travel of its runs, because friction may still vary at
//! the ends of a recording. The recorded travel then contains two and a half of the shortest waves.
//! Shorter variation is described by `pitch_ripple`.
//!
//! Source: Armstrong-Helouvry (1991), chapter 3, whose arm has a position-dependent friction in
//! each joint; Popovic & Goldenberg (1998), who model it by its Fourier series.

use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;
use core::f64::consts::FRAC_PI_2;

/// Dry friction that varies with the position along the stroke.
#[derive(Clone, Copy, Debug)]
pub struct StrokeDependence<T> {
    sizes: [T; 6],
    middle_m: T,
    inverse_half_1_m: T,
}

/// Description of the amplitude of one wave.
const fn wave(name: &'static str, meaning: &'static str) -> Parameter {
    Parameter::new(name, "-", meaning, [-2.0, 2.0], &[0.1]).null(0.0)
}

impl<T: Real> Effect<T> for StrokeDependence<T> {
    const INFO: Info = Info::new("stroke_dependence", Stage::Contact)
        .summary("dry friction that varies smoothly along the stroke")
        .equation(
            "F_dry -> F_dry (1 + sum of a_k w_k(u)), w_k = sin(k pi u/2) for k odd, cos(k pi u/2) for \
             k even, u = (x - x_0)/h within -1 and 1",
        )
        .source("Armstrong-Helouvry 1991, chapter 3; Popovic & Goldenberg 1998")
        .limits(
            "variations over less than a fifth of the stroke are smoothed; constant beyond \
             the ends; the position must be absolute or have the same zero in every run",
        )
        .parameters(&[
            wave("a_1", "half a wave: upper end higher than lower end").signed(),
            wave("a_2", "one wave: middle higher than both ends"),
            wave("a_3", "one and a half waves").signed(),
            wave("a_4", "two waves: middle and ends higher than the quarters"),
            wave("a_5", "two and a half waves").signed(),
            wave("a_6", "three waves"),
            Parameter::new("x_0", "m", "middle of the stroke", [-1e6, 1e6], &[0.1])
                .signed()
                .start(Start::StrokeMiddle)
                .stated(),
            Parameter::new("h", "m", "half of the stroke", [1e-9, 1e6], &[0.4])
                .log()
                .start(Start::StrokeHalf)
                .stated(),
        ])
        .needs(&[Need::NoFilm, Need::Position]);
    /// Radius that converts an angle to a position, m.
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            sizes: [
                parameters[0],
                parameters[1],
                parameters[2],
                parameters[3],
                parameters[4],
                parameters[5],
            ],
            middle_m: parameters[6],
            inverse_half_1_m: T::ONE / parameters[7],
        })
    }

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }
}

impl<T: Real> Contact<T> for StrokeDependence<T> {
    #[inline(always)]
    fn apply(&self, radius_m: &T, journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        let u = (journal.angle_rad * *radius_m - self.middle_m) * self.inverse_half_1_m;
        let u = u.max(-T::ONE).min(T::ONE);
        // cos 2q to cos 6q from one sine.
        let sine = (u * T::of(FRAC_PI_2)).sin();
        let square = sine * sine;
        let whole = T::ONE - T::of(2.0) * square;
        let third = sine * (T::of(3.0) - T::of(4.0) * square);
        let twice = T::of(2.0) * whole * whole - T::ONE;
        let fifth = T::of(2.0) * whole * third - sine;
        let sixth = whole * (T::of(2.0) * twice - T::ONE);
        let waves = [sine, whole, third, twice, fifth, sixth];
        let mut factor = T::ONE;
        for (size, wave) in self.sizes.iter().zip(waves) {
            factor += *size * wave;
        }
        sliding.jump *= factor.max(T::ZERO);
    }
}
