//! Rate-and-state friction with the ageing law, regularised at zero speed.
//!
//! ```text
//! F      = a asinh[|v|/(2 v_0) exp(psi/a)] sgn(v) + F_v v
//! psi    = F_0 + b ln(v_0 theta/D_c)
//! theta' = 1 - |v| theta/D_c
//! ```
//!
//! The variable theta is the age of the contact, s. Well above the speed `2 v_0 exp(-psi/a)` the
//! first line is `F_0 + a ln(|v|/v_0) + b ln(v_0 theta/D_c)`. If the speed increases by a factor of
//! e, friction rises by a at once, and falls by b while the age adapts over the slip distance D_c.
//! In steady sliding `theta = D_c/|v|`, so that `F = F_0 + (a - b) ln(|v|/v_0)`. For a = b = 0 the
//! law is that of Coulomb.
//!
//! Source: Dieterich (1979); Ruina (1983); Rice & Ben-Zion (1996) for the inverse hyperbolic sine,
//! which replaces the logarithm that diverges at rest.
//!
//! The speed below which the regularised force vanishes, proportional to exp(-F_0/a), is far below
//! any recorded speed. At a speed of exactly zero, friction is therefore set-valued
//! ([`Friction::jump`]), up to the force of steady sliding at the present age, at the speed
//! D_c/theta.
//!
//! The age is exact in a step of constant speed, and stable and positive in any step. Where the
//! speed changes linearly, the integral over the step has no elementary form. With the distances
//! `p` and `q` that the speeds at the start and the end of the step would cover in it, in units of
//! D_c:
//!
//! ```text
//! theta(dt) = theta exp(-(p + q)/2) + dt (1 - exp(-x))/x,   x (x + 3) = q (x + 3) - (q - p)
//! ```
//!
//! The last equation is exact to first order in the change of the speed for short steps, and in
//! the limit of long ones. The logarithm of the age is accurate to third order in short steps, to
//! 0.1 in steps of up to a hundred D_c, and to 0.23 in any step (one that comes to rest).
//!
//! ```
//! use jbf_core::law::rate_and_state::{RateAndState, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(RateAndState::new(Parameters { f_0: 4.0, a: 0.05, ..Parameters::default() })?);
//! let mut state = chain.start(&Motion::default());
//! for _ in 0..100 {
//!     chain.step_velocity(&mut state, 0.01, 0.001);
//! }
//! assert!(state.reading_n > 3.0 && state.reading_n < 7.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

use super::newtons::{in_newtons, moving};
use super::registry::named_law;
use super::{Info, Law, SteadyCurve};
use crate::described::described;
use crate::error::Error;
use crate::friction::Friction;
use crate::real::Real;

/// Smallest and largest age of a contact, s; the limits prevent an overflow in single precision.
pub(crate) const AGES_S: [f64; 2] = [1e-30, 1e30];
/// Longest sliding distance of a step in units of D_c; after a longer distance, the age is that of
/// steady sliding.
pub(crate) const LONGEST: f64 = 1e9;
/// Ratio of the force to the direct effect `a` above which the inverse hyperbolic sine equals a
/// logarithm.
pub(crate) const FAR_ABOVE_CREEP: f64 = 40.0;

/// Rate-and-state law: friction depends on the speed and on the age of the contact.
#[derive(Clone, Copy, Debug)]
pub struct RateAndState<T> {
    reference_n: T,
    direct_n: T,
    ageing_n: T,
    slip_m: T,
    reference_m_s: T,
    viscous_n_s_m: T,
    log_slip: T,
    log_reference: T,
}

impl<T: Real> RateAndState<T> {
    /// Age of the contact in steady sliding, s; at rest, that of the reference speed.
    #[inline(always)]
    fn steady_age_s(&self, speed_m_s: T) -> T {
        let speed_m_s = if speed_m_s > T::ZERO {
            speed_m_s
        } else {
            self.reference_m_s
        };
        limited(self.slip_m / speed_m_s)
    }

    /// Age after a step in which the speed changes linearly, s.
    #[inline(always)]
    fn older_s(&self, age_s: T, speed_m_s: [T; 2], dt_s: T) -> T {
        let [p, q] = speed_m_s.map(|v| (v * dt_s / self.slip_m).min(T::of(LONGEST)));
        let three = T::of(3.0);
        let root = ((q + three) * (q + three) - T::of(4.0) * (q - p)).sqrt();
        // Two forms of one solution, each without cancellation.
        let x = if q < three {
            T::of(2.0) * (q + q + p) / (root + three - q)
        } else {
            (q - three + root) * T::of(0.5)
        };
        let share = if x.value() < 1e-8 {
            T::ONE - x * T::of(0.5)
        } else {
            -(-x).exp_m1() / x
        };
        limited(age_s * (-(p + q) * T::of(0.5)).exp() + dt_s * share)
    }

    /// Unsigned friction without the viscous part, N.
    #[inline(always)]
    fn level_n(&self, age_s: T, velocity_m_s: T) -> T {
        let log_age = age_s.ln();
        let log_speed = if velocity_m_s == T::ZERO {
            self.log_slip - log_age
        } else {
            velocity_m_s.abs().ln()
        };
        let psi = self.reference_n + self.ageing_n * (log_age + self.log_reference - self.log_slip);
        let log_n = psi + self.direct_n * (log_speed - self.log_reference);
        if log_n > self.direct_n * T::of(FAR_ABOVE_CREEP) {
            return log_n;
        }
        if self.direct_n <= T::ZERO {
            return T::ZERO;
        }
        let sinh = (log_n / self.direct_n).exp() * T::of(0.5);
        self.direct_n * (sinh + (sinh * sinh + T::ONE).sqrt()).ln()
    }
}

/// Returns the age limited to [`AGES_S`], s.
#[inline(always)]
fn limited<T: Real>(age_s: T) -> T {
    age_s.max(T::of(AGES_S[0])).min(T::of(AGES_S[1]))
}

described! {
    named_law RateAndState = Info::new::<T, Self>("rate_and_state")
        .summary("friction that depends on the logarithms of speed and contact age")
        .equation(
            "F = a asinh[|v|/(2 v_0) exp((F_0 + b ln(v_0 theta/D_c))/a)] sgn(v) + F_v v, \
                   theta' = 1 - |v| theta/D_c",
        )
        .source("Dieterich 1979; Ruina 1983; Rice & Ben-Zion 1996")
        .limits(
            "no elastic deflection before sliding; constant normal load; valid over a few \
             decades of speed; contact age at the start of a run unknown",
        )
        .with_a_dry_level();
    f_0 = "F_0", "N", "friction in steady sliding at the speed v_0, without the viscous part",
        [1e-6, 1e7], [10.0] .log();
    a = "a", "N", "direct effect: immediate increase of friction per e-fold of the speed",
        [0.0, 1e7], [0.1];
    b = "b", "N", "ageing effect: increase of friction per e-fold of the contact age",
        [0.0, 1e7], [0.15];
    d_c = "D_c", "m", "slip distance over which the contact is renewed",
        [1e-12, 1e3], [1e-5, 1e-4, 1e-6] .log();
    v_0 = "v_0", "m/s", "reference speed of F_0",
        [1e-7, 1e3], [0.01] .log();
    F_v;
}

impl<T: Real> RateAndState<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            reference_n: p.f_0,
            direct_n: p.a,
            ageing_n: p.b,
            slip_m: p.d_c,
            reference_m_s: p.v_0,
            viscous_n_s_m: p.f_v,
            log_slip: p.d_c.ln(),
            log_reference: p.v_0.ln(),
        }
    }
}

impl<T: Real> Law<T> for RateAndState<T> {
    /// Age of the contact, s. Before the first step, zero represents the age of steady sliding.
    type State = T;

    in_newtons!();

    fn start(&self, _load_n: T) -> T {
        T::ZERO
    }

    #[inline(always)]
    fn friction(&self, age_s: &T, velocity_m_s: T) -> Friction<T> {
        let age_s = if *age_s > T::ZERO {
            *age_s
        } else {
            self.steady_age_s(velocity_m_s.abs())
        };
        Friction {
            jump: self.level_n(age_s, velocity_m_s),
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    /// Longest step, s: infinite, because a step is accurate for a speed that changes linearly, as
    /// between two samples.
    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn advance(&self, age_s: &mut T, speed_m_s: [T; 3], _rate: T, dt_s: T) {
        let [begin, middle, end] = speed_m_s;
        let half_s = dt_s * T::of(0.5);
        if *age_s <= T::ZERO {
            *age_s = self.steady_age_s(begin);
        }
        // In a step that reverses the middle is near rest: the two halves have one direction each.
        *age_s = self.older_s(*age_s, [begin, middle], half_s);
        *age_s = self.older_s(*age_s, [middle, end], half_s);
    }
}

impl SteadyCurve for RateAndState<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self.friction(&0.0, velocity_m_s).along(velocity_m_s.sign()))
    }
}
