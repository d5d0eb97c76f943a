//! Load-dependent viscous friction: `+ c L v`, L the load.
//!
//! Source: Hamon, Gautier & Garrec (2010) and Wolf & Iskandar (2018) for robot joints, whose
//! viscous slope grows with the transmitted torque. The effect also describes a seal that the
//! pressure presses on its rod.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction proportional to the load, in addition to that of the law.
#[derive(Clone, Copy, Debug)]
pub struct ViscousLoadDependence<T> {
    slope_s_m: T,
}

described! {
    named_effect ViscousLoadDependence = Info::new::<T, Self>("viscous_load_dependence", Stage::Contact)
        .summary("viscous friction that grows with the load, pressure or transmitted force")
        .equation("F -> F + c L v, L the recorded load")
        .source("Hamon, Gautier & Garrec 2010; Wolf & Iskandar 2018")
        .limits("linear in load and speed")
        .needs(&[Need::NoFilm, Need::Loads]);
    c = "c", "s/m", "viscous slope per load", [-1e4, 1e4], [0.1] null(0.0);
}

impl<T: Real> ViscousLoadDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { slope_s_m: p.c }
    }
}

impl<T: Real> Effect<T> for ViscousLoadDependence<T> {
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
        sliding.smooth += self.slope_s_m * journal.load_n * journal.velocity_m_s;
    }
}
