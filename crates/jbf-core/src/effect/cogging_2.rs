//! Second cogging force in addition to `cogging`, with its own pitch: `+ A sin(2 pi x/p - phi)`.
//!
//! The force of slots and poles has one pitch, that of an uneven magnet is periodic in a turn, and
//! each has harmonics. The fitted pitch therefore shows whether the second force is the harmonic
//! with half the pitch or has another cause.
//!
//! Source: as for `cogging`.

use super::cogging::{Cogging, PARAMETERS};
use super::{Effect, Info, Need, OtherFriction, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Second cogging force that is periodic in the position.
#[derive(Clone, Copy, Debug)]
pub struct SecondCogging<T>(Cogging<T>);

impl<T: Real> Effect<T> for SecondCogging<T> {
    const INFO: Info = Info::new("cogging_2", Stage::Other)
        .summary("second periodic motor force: a harmonic of the first, or another pitch")
        .equation("F -> F + A sin(2 pi x/p - phi), x the position of the surface, m")
        .source("Zhu & Howe 2000; Otten et al. 1997")
        .limits("one harmonic; the position must be absolute or have the same zero in every run")
        .parameters(PARAMETERS)
        .needs(&[Need::NoFilm, Need::Position])
        .further("cogging");
    /// Radius that converts an angle to a position, m.
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
