//! Load-dependent viscous friction: `+ c L v`, L the load.
//!
//! Source: Hamon, Gautier & Garrec (2010) and Wolf & Iskandar (2018) for robot joints, whose
//! viscous slope grows with the transmitted torque. The effect also describes a seal that the
//! pressure presses on its rod.

use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction proportional to the load, in addition to that of the law.
#[derive(Clone, Copy, Debug)]
pub struct ViscousLoadDependence<T> {
    slope_s_m: T,
}

impl<T: Real> Effect<T> for ViscousLoadDependence<T> {
    const INFO: Info = Info::new("viscous_load_dependence", Stage::Contact)
        .summary("viscous friction that grows with the load, pressure or transmitted force")
        .equation("F -> F + c L v, L the recorded load")
        .source("Hamon, Gautier & Garrec 2010; Wolf & Iskandar 2018")
        .limits("linear in load and speed")
        .parameters(&[
            Parameter::new("c", "s/m", "viscous slope per load", [-1e4, 1e4], &[0.1]).null(0.0),
        ])
        .needs(&[Need::NoFilm, Need::Loads]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            slope_s_m: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for ViscousLoadDependence<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        sliding.smooth += self.slope_s_m * journal.load_n * journal.velocity_m_s;
    }
}
