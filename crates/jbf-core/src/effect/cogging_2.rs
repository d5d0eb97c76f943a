//! Second cogging force in addition to `cogging`, with its own pitch: `+ A sin(2 pi x/p - phi)`.
//!
//! The force of slots and poles has one pitch, that of an uneven magnet is periodic in a turn, and
//! each has harmonics. The fitted pitch therefore shows whether the second force is the harmonic
//! with half the pitch or has another cause.
//!
//! Source: as for `cogging`.

use super::cogging::Cogging;
use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Second cogging force that is periodic in the position.
#[derive(Clone, Copy, Debug)]
pub struct SecondCogging<T>(Cogging<T>);

described! {
    named_effect SecondCogging = Info::new::<T, Self>("cogging_2", Stage::Other)
        .summary("second periodic motor force: a harmonic of the first, or another pitch")
        .equation("F -> F + A sin(2 pi x/p - phi), x the position of the surface, m")
        .source("Zhu & Howe 2000; Otten et al. 1997")
        .limits("one harmonic; the position must be absolute or have the same zero in every run")
        .needs(&[Need::NoFilm, Need::Position])
        .further("cogging");
    as super::cogging;
}

impl<T: Real> SecondCogging<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self(Cogging::with_parameters(p))
    }
}

impl<T: Real> Effect<T> for SecondCogging<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> T {
        self.0.start(motion, rig)
    }

    #[inline(always)]
    fn add_friction(
        &self,
        radius_m: &T,
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        self.0.add_friction(radius_m, journal, sum_n, transmitted_n);
    }
}
