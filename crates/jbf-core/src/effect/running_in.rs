//! Running-in: f_m multiplied by `1 + a exp(-s/s_0)`, with s the sliding distance in the run.
//!
//! Source: Cohn (1998), section 4.2 (the worn clearance); running-in after Blau (1989).

use super::registry::named_effect;
use super::{Effect, Info, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Asperity friction that changes with the sliding distance.
#[derive(Clone, Copy, Debug)]
pub struct RunningIn<T> {
    excess: T,
    inverse_distance_1_m: T,
}

described! {
    named_effect RunningIn = Info::new::<T, Self>("running_in", Stage::Contact)
        .summary("running-in of asperities: contact friction falls with the sliding distance")
        .equation("f_m -> f_m (1 + a exp(-s/s_0)), s the distance slid in the run")
        .source("Blau 1989; Cohn 1998, section 4.2")
        .limits(
            "each run starts with a fresh surface; wear that persists between runs is \
                 not included",
        );
    a = "a", "-", "relative excess of the fresh surface", [-0.95, 10.0], [0.2] null(0.0);
    s_0 = "s_0", "m", "sliding distance in which the excess decays to 1/e",
        [1e-3, 1e5], [1.0, 5.0] .log();
}

impl<T: Real> RunningIn<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            excess: p.a,
            inverse_distance_1_m: T::ONE / p.s_0,
        }
    }
}

impl<T: Real> Effect<T> for RunningIn<T> {
    /// Sliding distance since the start of the run, m.
    type State = T;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn contact(
        &self,
        state: &mut T,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        *state += from.distance_m(to, dt_s);
        let fresh = (-(*state * self.inverse_distance_1_m)).exp();
        sliding.jump *= T::ONE + self.excess * fresh;
    }
}
