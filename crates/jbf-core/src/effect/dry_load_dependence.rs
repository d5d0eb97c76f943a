//! Load-dependent dry friction: `+ mu L` on the friction that jumps with the direction, L the load.
//!
//! Source: Amontons (1699) and Coulomb (1785). Hamon, Gautier & Garrec (2010) for gears and
//! strain-wave drives, whose friction grows with the transmitted torque. The effect also describes
//! a seal that the pressure presses on its rod.
//!
//! A law in newtons does not depend on the load; with this effect, its dry friction is that without
//! load. A bristle deflects towards the sum of both.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction proportional to the load, in addition to the level of the law.
#[derive(Clone, Copy, Debug)]
pub struct DryLoadDependence<T> {
    coefficient: T,
}

described! {
    named_effect DryLoadDependence = Info::new::<T, Self>("dry_load_dependence", Stage::Contact)
        .summary("dry friction that grows with the load, pressure or transmitted force")
        .equation("F -> F + mu L sgn(v), L the recorded load; the level is never below zero")
        .source("Amontons 1699; Coulomb 1785; Hamon, Gautier & Garrec 2010")
        .limits("linear in the load; extrapolation beyond the recorded loads is not reliable")
        .needs(&[Need::NoFilm, Need::Loads]);
    mu = "mu", "-", "dry friction per load", [-10.0, 10.0], [0.1] null(0.0);
}

impl<T: Real> DryLoadDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { coefficient: p.mu }
    }
}

impl<T: Real> Effect<T> for DryLoadDependence<T> {
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
        let level = sliding.jump + self.coefficient * journal.load_n;
        sliding.jump = if level < T::ZERO { T::ZERO } else { level };
    }
}
