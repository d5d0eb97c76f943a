//! Direction-dependent viscous friction: `+ b |v|`.
//!
//! Source: the ball-screw axis of Janot, Gautier & Brunot (2019), in which only the viscous
//! friction depends on the direction; Armstrong-Helouvry et al. (1994) for direction-dependent
//! friction.
//!
//! In motion, a dry level that depends on the direction is equivalent to a zero error:
//! `sensor_offset`.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction whose slope differs between the two directions.
#[derive(Clone, Copy, Debug)]
pub struct ViscousAsymmetry<T> {
    slope_n_s_m: T,
}

described! {
    named_effect ViscousAsymmetry = Info::new::<T, Self>("viscous_asymmetry", Stage::Contact)
        .summary("viscous friction that is larger in one direction")
        .equation("F -> F + b |v|")
        .source("Janot, Gautier & Brunot 2019; Armstrong-Helouvry et al. 1994")
        .limits("linear in the speed, one slope per direction; identical slopes for b = 0")
        .needs(&[Need::NoFilm]);
    b = "b", "N s/m", "half of the difference of the slopes between the directions",
        [-1e7, 1e7], [1.0] null(0.0) .signed();
}

impl<T: Real> ViscousAsymmetry<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { slope_n_s_m: p.b }
    }
}

impl<T: Real> Effect<T> for ViscousAsymmetry<T> {
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
        sliding.smooth += self.slope_n_s_m * journal.velocity_m_s.abs();
    }
}
