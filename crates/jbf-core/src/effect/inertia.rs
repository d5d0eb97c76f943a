//! Reflected inertia: `+ m_e dv/dt`; the load cell also measures the force on an accelerated mass.
//!
//! Source: d'Alembert; the housing on the arm of Cohn's apparatus (1998, section 4.1), and any
//! drive force measured ahead of the moving mass.

use super::{Effect, Info, OtherFriction, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Reflected inertia of a mass in the force path.
#[derive(Clone, Copy, Debug)]
pub struct Inertia<T> {
    mass_kg: T,
}

impl<T: Real> Effect<T> for Inertia<T> {
    const INFO: Info = Info::new("inertia", Stage::Other)
        .summary("inertial force of a mass, contained in the measured force")
        .equation("F -> F + m_e dv/dt")
        .transmitted()
        .source("d'Alembert; Cohn 1998, section 4.1 (the housing on its arm)")
        .limits(
            "a rigid mass; the acceleration is derived from the recorded motion and has \
                 its noise",
        )
        .parameters(&[Parameter::new(
            "m_e",
            "kg",
            "effective mass at the sliding surface",
            [0.0, 1e6],
            &[4.0, 100.0],
        )
        .null(0.0)]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            mass_kg: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> OtherFriction<T> for Inertia<T> {
    #[inline(always)]
    fn friction_n(&self, _state: &(), journal: &JournalMotion<T>) -> Friction<T> {
        Friction {
            jump: T::ZERO,
            smooth: self.mass_kg * journal.acceleration_m_s2,
        }
    }
}
