//! Reflected inertia: `+ m_e dv/dt`; the load cell also measures the force on an accelerated mass.
//!
//! The force of a drive ([`Rig::force_at_drive`]) is measured ahead of a spring or gap: the mass then
//! moves with the drive, except for the part J behind the spring of `drive_compliance`.
//!
//! Source: d'Alembert; the housing on the arm of Cohn's apparatus (1998, section 4.1), and any
//! drive force measured ahead of the moving mass.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Reflected inertia of a mass in the force path.
#[derive(Clone, Copy, Debug)]
pub struct Inertia<T> {
    mass_kg: T,
}

described! {
    named_effect Inertia = Info::new::<T, Self>("inertia", Stage::Other)
        .summary("inertial force of a mass, contained in the measured force")
        .equation("F -> F + m_e dv/dt")
        .transmitted()
        .source("d'Alembert; Cohn 1998, section 4.1 (the housing on its arm)")
        .limits(
            "a rigid mass; the acceleration is derived from the recorded motion and has its noise; \
             at a drive with backlash, the mass on the motor's side of the gap",
        );
    m_e = "m_e", "kg", "effective mass at the sliding surface",
        [0.0, 1e6], [4.0, 100.0] null(0.0);
}

impl<T: Real> Inertia<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { mass_kg: p.m_e }
    }
}

impl<T: Real> Effect<T> for Inertia<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn add_friction(
        &self,
        _state: &(),
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let force_n = self.mass_kg * journal.measured_acceleration_m_s2 + journal.spring_inertia_n;
        sum_n.smooth += force_n;
        *transmitted_n += force_n;
    }
}
