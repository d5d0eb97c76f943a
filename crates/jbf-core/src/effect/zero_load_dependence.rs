//! Force proportional to the load and independent of the direction of motion: `+ k L`, L the load.
//!
//! Source: a pressure that acts on a rod's area; a screw or a guide that is not aligned with its
//! load. Hamon, Gautier & Garrec (2010) for the asymmetry of loaded transmissions.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Force proportional to the load, independent of the direction of motion.
#[derive(Clone, Copy, Debug)]
pub struct ZeroLoadDependence<T> {
    share: T,
}

described! {
    named_effect ZeroLoadDependence = Info::new::<T, Self>("zero_load_dependence", Stage::Other)
        .summary("force in one direction that grows with the load, pressure or transmitted force")
        .equation("F -> F + k L, L the recorded load")
        .source("Hamon, Gautier & Garrec 2010")
        .limits("linear in the load; also present at rest")
        .needs(&[Need::NoFilm, Need::Loads]);
    k = "k", "-", "force per load", [-10.0, 10.0], [0.01] null(0.0) .signed();
}

impl<T: Real> ZeroLoadDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { share: p.k }
    }
}

impl<T: Real> Effect<T> for ZeroLoadDependence<T> {
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
        sum_n.smooth += self.share * journal.load_n;
    }
}
