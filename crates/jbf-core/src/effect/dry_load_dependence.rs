//! Load-dependent dry friction: `+ mu L` on the friction that jumps with the direction, L the load.
//!
//! Source: Amontons (1699) and Coulomb (1785). Hamon, Gautier & Garrec (2010) for gears and
//! strain-wave drives, whose friction grows with the transmitted torque. The effect also describes
//! a seal that the pressure presses on its rod.
//!
//! A law in newtons does not depend on the load; with this effect, its dry friction is that without
//! load. A bristle deflects towards the sum of both.

use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction proportional to the load, in addition to the level of the law.
#[derive(Clone, Copy, Debug)]
pub struct DryLoadDependence<T> {
    coefficient: T,
}

impl<T: Real> Effect<T> for DryLoadDependence<T> {
    const INFO: Info = Info::new("dry_load_dependence", Stage::Contact)
        .summary("dry friction that grows with the load, pressure or transmitted force")
        .equation("F -> F + mu L sgn(v), L the recorded load; the level is never below zero")
        .source("Amontons 1699; Coulomb 1785; Hamon, Gautier & Garrec 2010")
        .limits("linear in the load; extrapolation beyond the recorded loads is not reliable")
        .parameters(&[
            Parameter::new("mu", "-", "dry friction per load", [-10.0, 10.0], &[0.1]).null(0.0),
        ])
        .needs(&[Need::NoFilm, Need::Loads]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            coefficient: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for DryLoadDependence<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        let level = sliding.jump + self.coefficient * journal.load_n;
        sliding.jump = if level < T::ZERO { T::ZERO } else { level };
    }
}
