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

use super::pitch::Pitch;
use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Cogging force that is periodic in the position.
#[derive(Clone, Copy, Debug)]
pub struct Cogging<T> {
    amplitude_n: T,
    pitch: Pitch<T>,
}

described! {
    named_effect Cogging = Info::new::<T, Self>("cogging", Stage::Other)
        .summary("motor force that is periodic in the position, also at rest")
        .equation("F -> F + A sin(2 pi x/p - phi), x the position of the surface, m")
        .source("Zhu & Howe 2000; Otten et al. 1997")
        .limits(
            "one harmonic; cogging_2 adds a second; the position must be absolute or \
                 have the same zero in every run",
        )
        .needs(&[Need::NoFilm, Need::Position]);
    a = "A", "N", "amplitude", [0.0, 1e7], [1.0] null(0.0);
    pitch = "pitch", "m", "length of one period, at the radius",
        [1e-6, 1e3], [0.5, 0.2] .log();
    phase_rad;
}

impl<T: Real> Cogging<T> {
    pub(super) fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            amplitude_n: p.a,
            pitch: Pitch::new(p.pitch, p.phase_rad),
        }
    }
}

impl<T: Real> Effect<T> for Cogging<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }

    #[inline(always)]
    fn add_friction(
        &self,
        radius_m: &T,
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        _transmitted_n: &mut T,
    ) {
        sum_n.smooth += self.amplitude_n * self.pitch.angle(journal.angle_rad * *radius_m).sin();
    }
}
