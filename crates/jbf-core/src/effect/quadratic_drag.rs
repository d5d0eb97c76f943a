//! Quadratic drag `+ c v |v|`: churning of oil.
//!
//! Source: turbulent drag after Rayleigh (1876); Cohn (1998), section 4.1, for flooded, gravity-fed
//! bearings.

use super::{Effect, Info, OtherFriction, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Drag that is proportional to the square of the speed.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticDrag<T> {
    drag_n_s2_m2: T,
}

impl<T: Real> Effect<T> for QuadraticDrag<T> {
    const INFO: Info = Info::new("quadratic_drag", Stage::Other)
        .summary("churning or windage: drag proportional to the square of the speed")
        .equation("F -> F + c v |v|")
        .source("Rayleigh 1876; Cohn 1998, section 4.1")
        .limits(
            "equal in both directions; laminar drag is proportional to the speed, which \
                 gamma represents",
        )
        .parameters(&[
            Parameter::new("c", "N s^2/m^2", "drag at 1 m/s", [0.0, 1e7], &[50.0]).null(0.0),
        ]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            drag_n_s2_m2: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> OtherFriction<T> for QuadraticDrag<T> {
    #[inline(always)]
    fn friction_n(&self, _state: &(), journal: &JournalMotion<T>) -> Friction<T> {
        Friction {
            jump: T::ZERO,
            smooth: self.drag_n_s2_m2 * journal.velocity_m_s * journal.velocity_m_s.abs(),
        }
    }
}
