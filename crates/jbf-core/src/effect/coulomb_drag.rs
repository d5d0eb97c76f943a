//! Coulomb drag `+ F_d sgn v`: dry friction that does not depend on the load of the bearing.
//!
//! Source: Cohn (1998), section 6.6 (the rig's ball bearings and seals); Coulomb (1785).

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction of seals and support bearings.
#[derive(Clone, Copy, Debug)]
pub struct CoulombDrag<T> {
    force_n: T,
}

described! {
    named_effect CoulombDrag = Info::new::<T, Self>("coulomb_drag", Stage::Other)
        .summary("dry friction of seals or support bearings, independent of the load")
        .equation("F -> F + F_d sgn(v)")
        .source("Cohn 1998, section 6.6")
        .limits("constant level; seals also stiffen with speed and pressure, which is not included")
        .needs(&[Need::NoDryLevel]);
    f_d = "F_d", "N", "drag force per bearing", [0.0, 1e4], [0.5] null(0.0);
}

impl<T: Real> CoulombDrag<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { force_n: p.f_d }
    }
}

impl<T: Real> Effect<T> for CoulombDrag<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn add_friction(
        &self,
        _state: &(),
        _journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        _transmitted_n: &mut T,
    ) {
        sum_n.jump += self.force_n;
    }
}
