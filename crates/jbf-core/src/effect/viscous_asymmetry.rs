//! Direction-dependent viscous friction: `+ b |v|`.
//!
//! Source: the ball-screw axis of Janot, Gautier & Brunot (2019), in which only the viscous
//! friction depends on the direction; Armstrong-Helouvry et al. (1994) for direction-dependent
//! friction.
//!
//! In motion, a dry level that depends on the direction is equivalent to a zero error:
//! `sensor_offset`.

use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;

/// Viscous friction whose slope differs between the two directions.
#[derive(Clone, Copy, Debug)]
pub struct ViscousAsymmetry<T> {
    slope_n_s_m: T,
}

impl<T: Real> Effect<T> for ViscousAsymmetry<T> {
    const INFO: Info = Info::new("viscous_asymmetry", Stage::Contact)
        .summary("viscous friction that is larger in one direction")
        .equation("F -> F + b |v|")
        .source("Janot, Gautier & Brunot 2019; Armstrong-Helouvry et al. 1994")
        .limits("linear in the speed, one slope per direction; identical slopes for b = 0")
        .parameters(&[Parameter::new(
            "b",
            "N s/m",
            "half of the difference of the slopes between the directions",
            [-1e7, 1e7],
            &[1.0],
        )
        .null(0.0)
        .signed()
        .start(Start::Damping)])
        .needs(&[Need::NoFilm]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            slope_n_s_m: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for ViscousAsymmetry<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        sliding.smooth += self.slope_n_s_m * journal.velocity_m_s.abs();
    }
}
