//! Friction ripple over a pitch of the travel: friction multiplied by `1 + a cos(2 pi x/p - phi)`.
//!
//! The pitch is that of a screw's lead, of recirculating balls, or of the teeth of a gear or belt.
//! The contact pressure varies with the position, and so does friction. The effect
//! `position_ripple` has a period of one turn of the shaft.
//!
//! Source: Armstrong-Helouvry (1991), chapter 3, where the friction of gears varies with the pitch
//! of the teeth.

use super::pitch::{Pitch, PHASE, PITCH};
use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;

/// Friction that is periodic in the position with a given pitch.
#[derive(Clone, Copy, Debug)]
pub struct PitchRipple<T> {
    depth: T,
    pitch: Pitch<T>,
}

/// Descriptions of the parameters amplitude, pitch and phase.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::new(
        "a",
        "-",
        "relative amplitude of the ripple",
        [0.0, 1.0],
        &[0.1],
    )
    .null(0.0),
    PITCH.start(Start::RipplePitch),
    PHASE,
];

impl<T: Real> Effect<T> for PitchRipple<T> {
    const INFO: Info = Info::new("pitch_ripple", Stage::Contact)
        .summary("friction that is periodic in the position: pitch of a screw, teeth, balls")
        .equation("f -> f (1 + a cos(2 pi x/p - phi)), x the position of the surface, m")
        .source("Armstrong-Helouvry 1991, chapter 3")
        .limits(
            "one harmonic; pitch_ripple_2 adds a second; the position must be absolute \
                 or have the same zero in every run",
        )
        .parameters(PARAMETERS)
        .needs(&[Need::NoFilm, Need::Position]);
    /// Radius that converts an angle to a position, m.
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            depth: parameters[0],
            pitch: Pitch::new(parameters[1], parameters[2]),
        })
    }

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }
}

impl<T: Real> Contact<T> for PitchRipple<T> {
    #[inline(always)]
    fn apply(&self, radius_m: &T, journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        let wave = self.pitch.angle(journal.angle_rad * *radius_m).cos();
        let factor = T::ONE + self.depth * wave;
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
