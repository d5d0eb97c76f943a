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

use super::{Bristle, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::law::bristle::bent;
use crate::motion::{JournalMotion, Motion};
use crate::page::Start;
use crate::path::legs;
use crate::real::Real;

/// Presliding: elastic deflection of the contact before it slides.
#[derive(Clone, Copy, Debug)]
pub struct Presliding<T> {
    stiffness_1_m: T,
}

impl<T: Real> Effect<T> for Presliding<T> {
    const INFO: Info = Info::new("presliding", Stage::Contact)
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
        .parameters(&[Parameter::new(
            "sigma",
            "1/m",
            "contact stiffness per load",
            [1.0, 1e12],
            &[3e3, 3e2, 3e4, 3e5],
        )
        .log()
        .null(f64::INFINITY)
        .start(Start::Stiffness)])
        .needs(&[Need::NoBristle])
        .longest_step_s(0.01);
    type State = T;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            stiffness_1_m: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> T {
        T::ZERO
    }
}

impl<T: Real> Bristle<T> for Presliding<T> {
    fn first(&self, state: &mut T, journal: &JournalMotion<T>, magnitude: T) -> T {
        *state = magnitude * journal.velocity_m_s.sign();
        *state
    }

    #[inline(always)]
    fn step(
        &self,
        state: &mut T,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> T {
        let turning = |share| magnitude[0] + (magnitude[1] - magnitude[0]) * share;
        for leg in legs(from, to, magnitude, turning, dt_s).iter().flatten() {
            *state = bent(*state, leg, self.stiffness_1_m);
        }
        *state
    }
}
