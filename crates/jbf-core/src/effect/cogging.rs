//! Cogging: a force that is periodic in the position, `+ A sin(2 pi x/p - phi)`.
//!
//! Teeth attract the magnets of a motor and alternately drive and brake it, in motion and at rest,
//! independently of friction. In a rotary motor the pitch is one turn divided by the least common
//! multiple of poles and slots. In a linear motor it is the pitch of the magnets. On the output
//! side of a gear or a screw, the pitch is divided by the ratio.
//!
//! `gravity` repeats once per turn of the shaft; the pitch of this effect is a parameter of the
//! fit. `pitch_ripple` scales friction instead and has no effect on a drive at rest.
//!
//! Source: Zhu & Howe (2000) for rotary machines; Otten et al. (1997) for linear ones.

use super::pitch::{Pitch, PHASE, PITCH};
use super::{Effect, Info, Need, OtherFriction, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;

/// Cogging force that is periodic in the position.
#[derive(Clone, Copy, Debug)]
pub struct Cogging<T> {
    amplitude_n: T,
    pitch: Pitch<T>,
}

/// Descriptions of the parameters amplitude, pitch and phase.
pub(super) const PARAMETERS: &[Parameter] = &[
    Parameter::new("A", "N", "amplitude", [0.0, 1e7], &[1.0])
        .null(0.0)
        .start(Start::Drag),
    PITCH,
    PHASE,
];

impl<T: Real> Effect<T> for Cogging<T> {
    const INFO: Info = Info::new("cogging", Stage::Other)
        .summary("motor force that is periodic in the position, also at rest")
        .equation("F -> F + A sin(2 pi x/p - phi), x the position of the surface, m")
        .source("Zhu & Howe 2000; Otten et al. 1997")
        .limits(
            "one harmonic; cogging_2 adds a second; the position must be absolute or \
                 have the same zero in every run",
        )
        .parameters(PARAMETERS)
        .needs(&[Need::NoFilm, Need::Position]);
    /// Radius that converts an angle to a position, m.
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            amplitude_n: parameters[0],
            pitch: Pitch::new(parameters[1], parameters[2]),
        })
    }

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }
}

impl<T: Real> OtherFriction<T> for Cogging<T> {
    #[inline(always)]
    fn friction_n(&self, radius_m: &T, journal: &JournalMotion<T>) -> Friction<T> {
        Friction {
            jump: T::ZERO,
            smooth: self.amplitude_n * self.pitch.angle(journal.angle_rad * *radius_m).sin(),
        }
    }
}
