//! Film memory: a factor on the rate of the film dynamics.
//!
//! The film follows the speed faster or more slowly than short-bearing theory predicts.
//!
//! Source: Cohn (1998): the bearing is of medium length (section 3.2), and the control programs use
//! a different time scale of the film (appendices D and E).

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Factor on the rate of the film dynamics.
#[derive(Clone, Copy, Debug)]
pub struct FilmMemory<T> {
    factor: T,
}

described! {
    named_effect FilmMemory = Info::new::<T, Self>("film_memory", Stage::Film)
        .summary("lubricant film that follows the speed more slowly (or faster) than in the law")
        .equation("d(eps, phi)/dt -> factor d(eps, phi)/dt")
        .source("Cohn 1998, section 3.2 and appendices D, E")
        .limits("one factor for squeeze and wedge; the steady state does not change")
        .needs(&[Need::Film]);
    factor = "factor", "-", "rate factor of the film", [1e-3, 1e3], [0.5, 2.0] null(1.0) .log();
}

impl<T: Real> FilmMemory<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { factor: p.factor }
    }
}

impl<T: Real> Effect<T> for FilmMemory<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn film_rate(&self, _state: &(), _journal: &JournalMotion<T>, rate: &mut T) {
        *rate *= self.factor;
    }
    #[inline(always)]
    fn fastest_film(&self) -> f64 {
        self.factor.value().max(1.0)
    }
}
