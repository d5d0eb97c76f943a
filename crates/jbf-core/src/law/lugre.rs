//! LuGre law in Olsson's form: bristles with a Stribeck curve and a damping that decays with speed.
//!
//! ```text
//! F  = sigma_0 z + sigma_1(v) z' + F_v v
//! z' = v - |v| z / g(v)
//! g(v)       = [F_c + (F_s - F_c) exp(-(v/v_s)^2)] / sigma_0
//! sigma_1(v) = sigma_1 exp(-(v/v_d)^2)
//! ```
//!
//! Source: Canudas de Wit, Olsson, Astrom & Lischinsky (1995); Olsson (1996); Cohn (1998), section
//! 2.3.1. The decay of sigma_1 with speed keeps the law passive where `sigma_1(v) |v| < 4 sigma_0
//! g(v)`. This holds everywhere if `sigma_1 v_d < 9 min(F_c, F_s)`.
//!
//! With `y = sigma_0 z`, y relaxes towards `sigma_0 g sgn(v)` over the sliding distance at the rate
//! `1/g`. The solution is exact in the distance if the level changes linearly. Any step is
//! therefore stable, and short steps are accurate to second order.
//!
//! ```
//! use jbf_core::law::lugre::{LuGre, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(LuGre::new(Parameters { f_c: 4.0, f_s: 6.0, ..Parameters::default() })?);
//! let mut state = chain.start(&Motion::default());
//! for _ in 0..100 {
//!     chain.step_velocity(&mut state, 0.01, 0.001);
//! }
//! assert!(state.reading_n > 3.0 && state.reading_n < 7.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

use super::bristle::{bent, LEAST_LEVEL};
use super::newtons::{in_newtons, moving};
use super::registry::named_law;
use super::{Info, Law, SteadyCurve};
use crate::described::described;
use crate::error::Error;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::path::legs;
use crate::real::Real;

/// Longest step with which the friction level, a nonlinear function of the speed, is sufficiently
/// accurate if it is linear in each step, s.
pub(crate) const LONGEST_STEP_S: f64 = 0.002;

/// LuGre law with Stribeck curve and viscous friction.
#[derive(Clone, Copy, Debug)]
pub struct LuGre<T> {
    coulomb_n: T,
    static_n: T,
    stribeck_m_s: T,
    stiffness_n_m: T,
    damping_n_s_m: T,
    damping_speed_m_s: T,
    viscous_n_s_m: T,
}

impl<T: Real> LuGre<T> {
    /// Level `sigma_0 g(v)` of the bristle force in steady sliding, N.
    #[inline(always)]
    fn level(&self, velocity_m_s: T) -> T {
        let share = velocity_m_s / self.stribeck_m_s;
        // Two positive parts: a difference could round to zero in single precision.
        let still = (-share * share).exp();
        self.coulomb_n * (T::ONE - still) + self.static_n * still
    }

    /// Damping force `sigma_1(v) z'` at the bristle force `force_n`, N.
    #[inline(always)]
    fn damping(&self, force_n: T, velocity_m_s: T, level: T) -> T {
        let share = velocity_m_s / self.damping_speed_m_s;
        let rate = velocity_m_s - velocity_m_s.abs() * force_n / level.max(T::of(LEAST_LEVEL));
        self.damping_n_s_m * (-share * share).exp() * rate
    }
}

described! {
    named_law LuGre = Info::new::<T, Self>("lugre")
        .summary("bristles with a Stribeck curve: presliding, breakaway and frictional lag")
        .equation(
            "F = sigma_0 z + sigma_1 exp(-(v/v_d)^2) z' + F_v v, z' = v - |v| z/g, \
                   sigma_0 g = F_c + (F_s - F_c) exp(-(v/v_s)^2)",
        )
        .source("Canudas de Wit et al. 1995; Olsson 1996; Cohn 1998, section 2.3.1")
        .limits("drifts under small vibration; frictional lag in sliding by the bristle only");
    F_c;
    F_s;
    v_s;
    sigma_0 = "sigma_0", "N/m", "stiffness of the bristles",
        [1e-2, 1e12], [1e5, 1e6, 1e4] .log();
    sigma_1 = "sigma_1", "N s/m", "damping of the bristles",
        [0.0, 1e7], [100.0];
    v_d = "v_d", "m/s", "speed at which the damping has decayed to 1/e",
        [1e-7, 1e3], [0.1] .log();
    F_v;
}

impl<T: Real> LuGre<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            coulomb_n: p.f_c,
            static_n: p.f_s,
            stribeck_m_s: p.v_s,
            stiffness_n_m: p.sigma_0,
            damping_n_s_m: p.sigma_1,
            damping_speed_m_s: p.v_d,
            viscous_n_s_m: p.f_v,
        }
    }
}

impl<T: Real> Law<T> for LuGre<T> {
    /// Bristle force `sigma_0 z`, N.
    type State = T;

    const HAS_BRISTLE: bool = true;

    const ENOUGH_STEPS: f64 = 16.0;

    in_newtons!();

    fn start(&self, _load_n: T) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn friction(&self, _state: &T, velocity_m_s: T) -> Friction<T> {
        Friction {
            jump: self.level(velocity_m_s),
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    /// Longest step for the accuracy of the friction level, s; the step is stable at any length.
    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        LONGEST_STEP_S
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
        let v = to.velocity_m_s;
        if dt_s.value() <= 0.0 {
            *state = level[1] * v.sign();
        } else {
            // At the reversal the level is the static level of the law, times the factor of the
            // contact effects on the levels at the ends.
            let turning = |_| {
                let own = self.level(from.velocity_m_s) + self.level(v);
                self.level(T::ZERO) * (level[0] + level[1]) / own
            };
            for leg in legs(from, to, level, turning, dt_s).iter().flatten() {
                *state = bent(*state, leg, self.stiffness_n_m);
            }
        }
        *state + self.damping(*state, v, level[1])
    }
}

impl SteadyCurve for LuGre<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self.friction(&0.0, velocity_m_s).along(velocity_m_s.sign()))
    }
}
