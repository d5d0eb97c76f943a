//! Direction-dependent friction: friction multiplied by `1 + a sgn v`.
//!
//! Source: mounted bearings and belts, whose side load increases friction in one direction and
//! reduces it in the other. Armstrong-Helouvry et al. (1994) list this asymmetry.

use super::{Contact, Effect, Info, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Friction that depends on the direction of motion.
#[derive(Clone, Copy, Debug)]
pub struct DirectionAsymmetry<T> {
    share: T,
}

impl<T: Real> Effect<T> for DirectionAsymmetry<T> {
    const INFO: Info = Info::new("direction_asymmetry", Stage::Contact)
        .summary("friction that is larger in one direction")
        .equation("f -> f (1 + a sgn(v))")
        .source("Armstrong-Helouvry et al. 1994; Cohn 1998, section 4.1 (belt drive)")
        .limits(
            "scales the whole friction; on a drive, dry_asymmetry and viscous_asymmetry \
             scale its parts; a sensor offset shifts the force instead, also at rest",
        )
        .parameters(&[Parameter::new(
            "a",
            "-",
            "relative excess of friction in positive motion",
            [-0.95, 0.95],
            &[0.05],
        )
        .null(0.0)
        .signed()]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            share: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for DirectionAsymmetry<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        let factor = T::ONE + self.share * journal.way();
        sliding.jump *= factor;
        sliding.smooth *= factor;
    }
}
