//! Presliding by bristles: `z' = v - |v| sigma z / f`, friction coefficient `sigma z`, with f the
//! coefficient that the contact would have in sliding.
//!
//! For a law in newtons, only the dry friction deflects and the viscous friction is added, as in
//! the laws of Dahl and LuGre.
//!
//! Source: Dahl (1968); Canudas de Wit et al. (1995); Cohn (1998), section 2.1.3. Instead of a jump
//! at a reversal, friction changes over the distance f / sigma.
//!
//! With `c = sigma z` this is a relaxation of c towards `f sgn(v)` over distance. A step is
//! therefore solved exactly in the sliding distance, and any stiffness is stable.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::law::bristle::bent;
use crate::motion::{JournalMotion, Motion};
use crate::path::legs;
use crate::real::Real;

/// Presliding: elastic deflection of the contact before it slides.
#[derive(Clone, Copy, Debug)]
pub struct Presliding<T> {
    stiffness_1_m: T,
}

described! {
    named_effect Presliding = Info::new::<T, Self>("presliding", Stage::Contact)
        .summary(
            "elastic deflection of the contact before sliding: after a reversal \
                  friction changes over a distance",
        )
        .equation(
            "z' = v - |v| sigma z / f; friction coefficient sigma z, f the sliding friction \
             (for a law in newtons its dry part; the viscous part is added)",
        )
        .source("Dahl 1968; Canudas de Wit et al. 1995; Cohn 1998, section 2.1.3")
        .limits(
            "one stiffness, no memory of inner loops, drifts under small vibration; \
             elasto-plastic models are better below the breakaway distance",
        )
        .needs(&[Need::NoBristle]);
    sigma = "sigma", "1/m", "contact stiffness per load",
        [1.0, 1e12], [3e3, 3e2, 3e4, 3e5] null(f64::INFINITY) .log();
}

impl<T: Real> Presliding<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            stiffness_1_m: p.sigma,
        }
    }
}

impl<T: Real> Effect<T> for Presliding<T> {
    type State = T;
    const LONGEST_STEP_S: f64 = 0.01;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn bristle(
        &self,
        state: &mut T,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        deflected: &mut Option<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) {
        if deflected.is_some() {
            return;
        }
        if dt_s > T::ZERO {
            let turning = |share| magnitude[0] + (magnitude[1] - magnitude[0]) * share;
            for leg in legs(from, to, magnitude, turning, dt_s).iter().flatten() {
                *state = bent(*state, leg, self.stiffness_1_m);
            }
        } else {
            *state = magnitude[1] * to.velocity_m_s.sign();
        }
        *deflected = Some(*state);
    }
}
