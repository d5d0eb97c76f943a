//! A second force over a pitch beside `cogging`, at a pitch of its own: `+ A sin(2 pi x/p - phi)`.
//!
//! Slots and poles cog at one pitch, an uneven magnet once a turn, and each has harmonics: a second
//! wave at half the pitch, or at another. Which it is, the pitch that the fit finds says.
//!
//! Source: that of `cogging`.

use super::cogging::{Cogging, PARAMETERS};
use super::{Effect, Info, Need, OtherFriction, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// A force over another pitch.
#[derive(Clone, Copy, Debug)]
pub struct SecondCogging<T>(Cogging<T>);

impl<T: Real> Effect<T> for SecondCogging<T> {
    const INFO: Info = Info::new("cogging_2", Stage::Other)
        .summary("a second force over a pitch beside the first: a harmonic, or another pitch")
        .equation("F -> F + A sin(2 pi x/p - phi), x the way of the surface, m")
        .source("Zhu & Howe 2000; Otten et al. 1997")
        .limits("one wave; the way must be absolute or have the same zero in every run")
        .parameters(PARAMETERS)
        .needs(&[Need::NoFilm, Need::Position])
        .further("cogging");
    /// Radius, m.
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Cogging::new(parameters).map(Self)
    }

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> T {
        self.0.start(motion, rig)
    }
}

impl<T: Real> OtherFriction<T> for SecondCogging<T> {
    #[inline(always)]
    fn friction_n(&self, radius_m: &T, journal: &JournalMotion<T>) -> Friction<T> {
        self.0.friction_n(radius_m, journal)
    }
}
