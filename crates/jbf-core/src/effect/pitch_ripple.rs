//! Friction ripple over a pitch of the travel: friction multiplied by `1 + a cos(2 pi x/p - phi)`.
//!
//! The pitch is that of a screw's lead, of recirculating balls, or of the teeth of a gear or belt.
//! The contact pressure varies with the position, and so does friction. The effect
//! `position_ripple` has a period of one turn of the shaft.
//!
//! Source: Armstrong-Helouvry (1991), chapter 3, where the friction of gears varies with the pitch
//! of the teeth.

use super::pitch::Pitch;
use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Friction that is periodic in the position with a given pitch.
#[derive(Clone, Copy, Debug)]
pub struct PitchRipple<T> {
    depth: T,
    pitch: Pitch<T>,
}

described! {
    named_effect PitchRipple = Info::new::<T, Self>("pitch_ripple", Stage::Contact)
        .summary("friction that is periodic in the position: pitch of a screw, teeth, balls")
        .equation("f -> f (1 + a cos(2 pi x/p - phi)), x the position of the surface, m")
        .source("Armstrong-Helouvry 1991, chapter 3")
        .limits(
            "one harmonic; pitch_ripple_2 adds a second; the position must be absolute \
                 or have the same zero in every run",
        )
        .needs(&[Need::NoFilm, Need::Position]);
    a = "a", "-", "relative amplitude of the ripple", [0.0, 1.0], [0.1] null(0.0);
    pitch = "pitch", "m", "length of one period, at the radius",
        [1e-6, 1e3], [0.5, 0.2] .log();
    phase_rad;
}

impl<T: Real> PitchRipple<T> {
    pub(super) fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            depth: p.a,
            pitch: Pitch::new(p.pitch, p.phase_rad),
        }
    }
}

impl<T: Real> Effect<T> for PitchRipple<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }

    #[inline(always)]
    fn contact(
        &self,
        radius_m: &mut T,
        _from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        _dt_s: T,
    ) {
        let wave = self.pitch.angle(journal.angle_rad * *radius_m).cos();
        let factor = T::ONE + self.depth * wave;
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
