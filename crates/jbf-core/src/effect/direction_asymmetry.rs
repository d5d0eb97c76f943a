//! Direction-dependent friction: friction multiplied by `1 + a sgn v`.
//!
//! Source: mounted bearings and belts, whose side load increases friction in one direction and
//! reduces it in the other. Armstrong-Helouvry et al. (1994) list this asymmetry.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Friction that depends on the direction of motion.
#[derive(Clone, Copy, Debug)]
pub struct DirectionAsymmetry<T> {
    share: T,
}

described! {
    named_effect DirectionAsymmetry = Info::new::<T, Self>("direction_asymmetry", Stage::Contact)
        .summary("friction that is larger in one direction")
        .equation("f -> f (1 + a sgn(v))")
        .source("Armstrong-Helouvry et al. 1994; Cohn 1998, section 4.1 (belt drive)")
        .limits(
            "scales the whole friction; on a drive, dry_asymmetry and viscous_asymmetry \
             scale its parts; a sensor offset shifts the force instead, also at rest",
        );
    a = "a", "-", "relative excess of friction in positive motion",
        [-0.95, 0.95], [0.05] null(0.0) .signed();
}

impl<T: Real> DirectionAsymmetry<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { share: p.a }
    }
}

impl<T: Real> Effect<T> for DirectionAsymmetry<T> {
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
        let factor = T::ONE + self.share * journal.way();
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
