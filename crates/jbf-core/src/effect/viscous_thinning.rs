//! Viscous friction that grows less than proportionally to the speed: `F_v v -> F_v v / (1 + w
//! |v|)`.
//!
//! Source: Cross (1965) with exponent one, for grease that thins in shear; Grotjahn, Daemi &
//! Heimann (2001) and Bona & Indri (2005) for robot joints, whose viscous friction flattens. The
//! latter use a power below one, whose slope at rest is unbounded.
//!
//! w is the inverse of the speed at which the friction is half of the linear value. A fit can reach
//! the null value of w, zero, whereas the null value of the speed would be infinite.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction that grows less than proportionally to the speed.
#[derive(Clone, Copy, Debug)]
pub struct ViscousThinning<T> {
    slowness_s_m: T,
}

described! {
    named_effect ViscousThinning = Info::new::<T, Self>("viscous_thinning", Stage::Contact)
        .summary("viscous friction that flattens with the speed: shear thinning of grease")
        .equation("F_v v -> F_v v / (1 + w |v|)")
        .source("Cross 1965; Grotjahn, Daemi & Heimann 2001; Bona & Indri 2005")
        .limits(
            "one shape: it saturates at F_v/w; heating of the lubricant also flattens \
                 the curve",
        )
        .needs(&[Need::NoFilm]);
    w = "w", "s/m", "inverse of the speed at which the viscous friction is half of the linear value",
        [0.0, 1e6], [10.0] null(0.0);
}

impl<T: Real> ViscousThinning<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { slowness_s_m: p.w }
    }
}

impl<T: Real> Effect<T> for ViscousThinning<T> {
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
        let thinner = T::ONE + journal.velocity_m_s.abs() * self.slowness_s_m;
        sliding.smooth /= thinner;
    }
}
