//! Single-state elasto-plastic law: elastic up to a breakaway force, then plastic.
//!
//! ```text
//! dF/dx = sigma_0                                     while F sgn(v) < b F_c
//!       = sigma_0 (1 - (F/F_c) sgn(v))/(1 - b)        beyond;       + F_v v
//! ```
//!
//! Source: Dupont, Hayward, Armstrong & Altpeter (2002), `z' = v (1 - alpha(z, v) sgn(v) z/z_ss)`
//! with `F = sigma_0 z`. There alpha = 0 up to the breakaway displacement `z_ba = b F_c/sigma_0`
//! and on unloading, and 1 at `z_ss = F_c/sigma_0`. The authors do not prescribe the increase of
//! alpha between these points, and use half a sine. Here it is `alpha = (1 - z_ba/|z|)/(1 - b)`:
//! the force then approaches its level exponentially. A step is solved exactly in the sliding
//! distance, first up to breakaway and then beyond it, so any step length is stable.
//!
//! A load or a vibration that stays below the breakaway causes no lasting displacement, whereas the
//! laws of Dahl and LuGre drift. As b approaches 1 the law becomes a spring and a slider. The
//! effect `stribeck_excess` adds a Stribeck curve, and `dry_load_dependence` a friction level that
//! grows with the load. Both change F_c and leave sigma_0 and b constant.
//!
//! ```
//! use jbf_core::law::elasto_plastic::{ElastoPlastic, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(ElastoPlastic::new(Parameters { f_c: 4.0, sigma_0: 1e5, ..Parameters::default() })?);
//! let mut state = chain.start(&Motion::default());
//! for _ in 0..100 {
//!     chain.step_velocity(&mut state, 0.01, 0.001);
//! }
//! assert!(state.reading_n > 3.0 && state.reading_n < 7.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

use super::bristle::{along, bent};
use super::newtons::{in_newtons, moving};
use super::registry::named_law;
use super::{Info, Law, SteadyCurve};
use crate::described::described;
use crate::error::Error;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::path::Leg;
use crate::real::Real;

/// Law with an elastic and a plastic deflection of the contact.
#[derive(Clone, Copy, Debug)]
pub struct ElastoPlastic<T> {
    coulomb_n: T,
    stiffness_n_m: T,
    breakaway: T,
    viscous_n_s_m: T,
}

impl<T: Real> ElastoPlastic<T> {
    /// Force at the end of a leg (a part of a step in one direction) that begins with `force_n`, N.
    #[inline(always)]
    fn slide(&self, force_n: T, leg: &Leg<T>) -> T {
        let (way, [begin, end]) = (leg.direction, leg.level);
        let plastic_n_m = self.stiffness_n_m / (T::ONE - self.breakaway);
        // Distance of the force from breakaway, and the amount by which the leg reduces it; both
        // are linear in the distance.
        let gap = self.breakaway * begin - way * force_n;
        if gap.value() <= 0.0 {
            return bent(force_n, leg, plastic_n_m);
        }
        let rise = self.stiffness_n_m * leg.distance_m;
        let closing = rise - self.breakaway * (end - begin);
        if closing <= gap {
            return force_n + way * rise;
        }
        let share = gap / closing;
        let at_breakaway = begin + (end - begin) * share;
        let beyond = Leg {
            direction: way,
            distance_m: leg.distance_m * (T::ONE - share),
            level: [at_breakaway, end],
        };
        bent(way * self.breakaway * at_breakaway, &beyond, plastic_n_m)
    }
}

described! {
    named_law ElastoPlastic = Info::new::<T, Self>("elasto_plastic")
        .summary("elastic up to a breakaway force, plastic beyond: no drift below it")
        .equation(
            "dF/dx = sigma_0 while F sgn(v) < b F_c, sigma_0 (1 - (F/F_c) sgn(v))/(1 - b) beyond; \
                   + F_v v",
        )
        .source("Dupont, Hayward, Armstrong & Altpeter 2002")
        .limits("no Stribeck effect of its own; inner loops beyond the breakaway force drift");
    F_c;
    sigma_0 = "sigma_0", "N/m", "stiffness up to breakaway",
        [1e-2, 1e12], [1e5, 1e6, 1e4] .log();
    breakaway = "breakaway", "-", "fraction of F_c up to which the contact is elastic",
        [0.0, 0.999], [0.7, 0.2];
    F_v;
}

impl<T: Real> ElastoPlastic<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            coulomb_n: p.f_c,
            stiffness_n_m: p.sigma_0,
            breakaway: p.breakaway,
            viscous_n_s_m: p.f_v,
        }
    }
}

impl<T: Real> Law<T> for ElastoPlastic<T> {
    /// Force of the bristle, N.
    type State = T;

    const HAS_BRISTLE: bool = true;

    in_newtons!();

    fn start(&self, _load_n: T) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn friction(&self, _state: &T, velocity_m_s: T) -> Friction<T> {
        Friction {
            jump: self.coulomb_n,
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn advance(&self, _state: &mut T, _speed_m_s: [T; 3], _rate: T, _dt_s: T) {}

    #[inline(always)]
    fn bend(
        &self,
        state: &mut T,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        along(state, from, to, level, dt_s, |force, leg| {
            self.slide(force, leg)
        })
    }
}

impl SteadyCurve for ElastoPlastic<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self.friction(&0.0, velocity_m_s).along(velocity_m_s.sign()))
    }
}
