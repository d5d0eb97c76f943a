//! Second friction ripple in addition to `pitch_ripple`, with its own pitch: friction multiplied by
//! `1 + a cos(2 pi x/p - phi)`.
//!
//! A ripple is rarely a single wave. The second harmonic has half the pitch, and the pitch at which
//! the balls of a screw recirculate differs from its lead. The fitted pitch distinguishes the two.
//!
//! Source: as for `pitch_ripple`.

use super::pitch_ripple::PitchRipple;
use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Friction that is periodic in the position with a second pitch.
#[derive(Clone, Copy, Debug)]
pub struct SecondPitchRipple<T>(PitchRipple<T>);

described! {
    named_effect SecondPitchRipple = Info::new::<T, Self>("pitch_ripple_2", Stage::Contact)
        .summary("second periodic variation of friction: a harmonic of the first, or another pitch")
        .equation("f -> f (1 + a cos(2 pi x/p - phi)), x the position of the surface, m")
        .source("Armstrong-Helouvry 1991, chapter 3")
        .limits("one harmonic; the position must be absolute or have the same zero in every run")
        .needs(&[Need::NoFilm, Need::Position])
        .further("pitch_ripple");
    as super::pitch_ripple;
}

impl<T: Real> SecondPitchRipple<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self(PitchRipple::with_parameters(p))
    }
}

impl<T: Real> Effect<T> for SecondPitchRipple<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> T {
        self.0.start(motion, rig)
    }

    #[inline(always)]
    fn contact(
        &self,
        radius_m: &mut T,
        from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        self.0.contact(radius_m, from, journal, sliding, dt_s);
    }
}
