//! Direction-dependent dry friction: dry friction multiplied by `1 + a sgn v`, with the same `a` at
//! every speed.
//!
//! A preload by a wedge, a wiper or a helix angle increases dry friction in one direction and
//! reduces it in the other, including the Stribeck peak. Viscous friction does not depend on the
//! preload.
//!
//! If the dry friction is the same at every speed, position and load, this effect in motion is
//! equivalent to a constant force, `sensor_offset`. Only the constant force acts at rest.
//!
//! Source: Armstrong-Helouvry et al. (1994), who list this asymmetry.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction that depends on the direction of motion.
#[derive(Clone, Copy, Debug)]
pub struct DryAsymmetry<T> {
    share: T,
}

described! {
    named_effect DryAsymmetry = Info::new::<T, Self>("dry_asymmetry", Stage::Contact)
        .summary("dry friction that is larger in one direction")
        .equation("F_dry -> F_dry (1 + a sgn(v))")
        .source("Armstrong-Helouvry et al. 1994")
        .limits(
            "with a constant dry level, only rests distinguish it from a constant force \
             (sensor_offset)",
        )
        .needs(&[Need::NoFilm]);
    a = "a", "-", "relative excess of dry friction in positive motion",
        [-0.95, 0.95], [0.05] null(0.0) .signed();
}

impl<T: Real> DryAsymmetry<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { share: p.a }
    }
}

impl<T: Real> Effect<T> for DryAsymmetry<T> {
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
        sliding.jump *= T::ONE + self.share * journal.way();
    }
}
