//! Coulomb drag `+ F_d sgn v`: dry friction that does not depend on the load of the bearing.
//!
//! Source: Cohn (1998), section 6.6 (the rig's ball bearings and seals); Coulomb (1785).

use super::{Effect, Info, Need, OtherFriction, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::real::Real;

/// Dry friction of seals and support bearings.
#[derive(Clone, Copy, Debug)]
pub struct CoulombDrag<T> {
    force_n: T,
}

impl<T: Real> Effect<T> for CoulombDrag<T> {
    const INFO: Info = Info::new("coulomb_drag", Stage::Other)
        .summary("dry friction of seals or support bearings, independent of the load")
        .equation("F -> F + F_d sgn(v)")
        .source("Cohn 1998, section 6.6")
        .limits("constant level; seals also stiffen with speed and pressure, which is not included")
        .parameters(&[
            Parameter::new("F_d", "N", "drag force per bearing", [0.0, 1e4], &[0.5])
                .null(0.0)
                .start(Start::Drag),
        ])
        .needs(&[Need::NoDryLevel]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            force_n: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> OtherFriction<T> for CoulombDrag<T> {
    #[inline(always)]
    fn friction_n(&self, _state: &(), _journal: &JournalMotion<T>) -> Friction<T> {
        Friction {
            jump: self.force_n,
            smooth: T::ZERO,
        }
    }
}
