//! Friction ripple over a turn: friction multiplied by `1 + a cos(theta - theta_0)`.
//!
//! Source: Cohn (1998), section 2.4.1, after Armstrong-Helouvry's look-up tables of friction
//! against joint angle; in a journal, the cause is out-of-roundness.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Friction that is periodic in the angle of the shaft.
#[derive(Clone, Copy, Debug)]
pub struct PositionRipple<T> {
    depth: T,
    cos_offset: T,
    sin_offset: T,
}

described! {
    named_effect PositionRipple = Info::new::<T, Self>("position_ripple", Stage::Contact)
        .summary("friction that varies once per revolution (roundness, alignment)")
        .equation("f -> f (1 + a cos(theta - theta_0))")
        .source("Cohn 1998, section 2.4.1; Armstrong-Helouvry 1991")
        .limits(
            "one harmonic per revolution; belts and gears add others; the angle must be \
             absolute or have the same zero in every run",
        )
        .needs(&[Need::Angle]);
    a = "a", "-", "relative amplitude of the ripple", [0.0, 1.0], [0.1] null(0.0);
    theta_0_rad = "theta_0_rad", "rad", "angle of maximum friction",
        [-4.0 * PI, 4.0 * PI], [0.0, FRAC_PI_2, PI, -FRAC_PI_2] .period(TAU).signed();
}

impl<T: Real> PositionRipple<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            depth: p.a,
            cos_offset: p.theta_0_rad.cos(),
            sin_offset: p.theta_0_rad.sin(),
        }
    }
}

impl<T: Real> Effect<T> for PositionRipple<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn contact(
        &self,
        _state: &mut (),
        _from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        _dt_s: T,
    ) {
        // cos(theta - theta_0) from the precomputed cosine and sine of the offset.
        let wave =
            journal.angle_rad.cos() * self.cos_offset + journal.angle_rad.sin() * self.sin_offset;
        let factor = T::ONE + self.depth * wave;
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
