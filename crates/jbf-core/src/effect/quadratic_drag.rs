//! Quadratic drag `+ c v |v|`: churning of oil.
//!
//! Source: turbulent drag after Rayleigh (1876); Cohn (1998), section 4.1, for flooded, gravity-fed
//! bearings.

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Drag that is proportional to the square of the speed.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticDrag<T> {
    drag_n_s2_m2: T,
}

described! {
    named_effect QuadraticDrag = Info::new::<T, Self>("quadratic_drag", Stage::Other)
        .summary("churning or windage: drag proportional to the square of the speed")
        .equation("F -> F + c v |v|")
        .source("Rayleigh 1876; Cohn 1998, section 4.1")
        .limits(
            "equal in both directions; laminar drag is proportional to the speed, which \
                 gamma represents",
        );
    c = "c", "N s^2/m^2", "drag at 1 m/s", [0.0, 1e7], [50.0] null(0.0);
}

impl<T: Real> QuadraticDrag<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { drag_n_s2_m2: p.c }
    }
}

impl<T: Real> Effect<T> for QuadraticDrag<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn add_friction(
        &self,
        _state: &(),
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        _transmitted_n: &mut T,
    ) {
        sum_n.smooth += self.drag_n_s2_m2 * journal.velocity_m_s * journal.velocity_m_s.abs();
    }
}
