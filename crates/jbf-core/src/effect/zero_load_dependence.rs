//! Force proportional to the load and independent of the direction of motion: `+ k L`, L the load.
//!
//! Source: a pressure that acts on a rod's area; a screw or a guide that is not aligned with its
//! load. Hamon, Gautier & Garrec (2010) for the asymmetry of loaded transmissions.

use super::{Effect, Info, Need, OtherFriction, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Force proportional to the load, independent of the direction of motion.
#[derive(Clone, Copy, Debug)]
pub struct ZeroLoadDependence<T> {
    share: T,
}

impl<T: Real> Effect<T> for ZeroLoadDependence<T> {
    const INFO: Info = Info::new("zero_load_dependence", Stage::Other)
        .summary("force in one direction that grows with the load, pressure or transmitted force")
        .equation("F -> F + k L, L the recorded load")
        .source("Hamon, Gautier & Garrec 2010")
        .limits("linear in the load; also present at rest")
        .parameters(&[
            Parameter::new("k", "-", "force per load", [-10.0, 10.0], &[0.01])
                .null(0.0)
                .signed(),
        ])
        .needs(&[Need::NoFilm, Need::Loads]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            share: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> OtherFriction<T> for ZeroLoadDependence<T> {
    #[inline(always)]
    fn friction_n(&self, _state: &(), journal: &JournalMotion<T>) -> Friction<T> {
        Friction {
            jump: T::ZERO,
            smooth: self.share * journal.load_n,
        }
    }
}
