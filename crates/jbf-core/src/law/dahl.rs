//! Dahl law `dF/dx = sigma_0 |1 - (F/F_c) sgn(v)|^i sgn(1 - (F/F_c) sgn(v))`, x the sliding
//! distance.
//!
//! Source: Dahl (1968, 1977). The usual exponent is i = 1. For i below 1 (ductile), the force
//! reaches F_c after a finite distance; for i above 1 (brittle), it approaches F_c slowly. In the
//! limit of large sigma_0, the law is that of Coulomb.
//!
//! The law is rate-independent, so a step is solved in the sliding distance, in closed form for any
//! i. With `u = 1 - (F/F_c) sgn(v)` and `k = sigma_0/F_c`:
//!
//! ```text
//! u(s) = u_0 (1 - (1 - i) k s u_0^(i-1))^(1/(1-i)),   u_0 exp(-k s) for i = 1
//! ```
//!
//! ```
//! use jbf_core::law::dahl::{Dahl, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(Dahl::new(Parameters { f_c: 4.0, sigma_0: 1e5, ..Parameters::default() })?);
//! let mut state = chain.start(&Motion::default());
//! for _ in 0..100 {
//!     chain.step_velocity(&mut state, 0.01, 0.001);
//! }
//! assert!(state.reading_n > 3.0 && state.reading_n < 7.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

use super::bristle::{along, LEAST_LEVEL};
use super::newtons::{in_newtons, moving};
use super::registry::named_law;
use super::{Info, Law, SteadyCurve};
use crate::described::described;
use crate::error::Error;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::path::Leg;
use crate::real::Real;

/// Bristle whose deflection depends on the sliding distance only.
#[derive(Clone, Copy, Debug)]
pub struct Dahl<T> {
    coulomb_n: T,
    stiffness_n_m: T,
    exponent: T,
    viscous_n_s_m: T,
}

impl<T: Real> Dahl<T> {
    /// Force at the end of a leg (a part of a step in one direction) that begins with `force_n`, N.
    #[inline(always)]
    fn slide(&self, force_n: T, leg: &Leg<T>) -> T {
        if leg.distance_m.value() <= 0.0 {
            return force_n;
        }
        let way = leg.direction;
        let mean = ((leg.level[0] + leg.level[1]) * T::of(0.5)).max(T::of(LEAST_LEVEL));
        let ratio = self.stiffness_n_m * leg.distance_m / mean;
        // The distance is so short that its ratio rounds to zero.
        if ratio <= T::ZERO {
            return force_n;
        }
        let lacking = T::ONE - way * force_n / mean;
        let left = lacking.sign() * self.decay(lacking.abs(), ratio);
        // A level that changes during the leg (a ripple) enters as its mean. This is the term that
        // the closed form of a ramp for i = 1 adds, so that a sliding bristle ends at level[1].
        let gain = -(-ratio).exp_m1();
        let change = leg.level[1] - leg.level[0];
        way * (mean * (T::ONE - left) + change * (T::of(0.5) * (T::of(2.0) - gain) - gain / ratio))
    }

    /// Value of `u` after the distance s with `ratio = k s`, from its value at s = 0.
    #[inline(always)]
    fn decay(&self, u: T, ratio: T) -> T {
        // So close to sliding, powers below one would lose their digits.
        if u.value() < 1e-12 {
            return u;
        }
        let m = T::ONE - self.exponent;
        let y = ratio * u.powf(-m);
        let x = m * y;
        if x.value() >= 1.0 {
            return T::ZERO;
        }
        // -ln(1 - x)/m, by its series where the difference would cancel.
        let power = if x.value().abs() < 1e-3 {
            let of = |k: f64| T::of(1.0 / k);
            y * (T::ONE + x * (of(2.0) + x * (of(3.0) + x * (of(4.0) + x * of(5.0)))))
        } else {
            -(T::ONE - x).ln() / m
        };
        u * (-power).exp()
    }
}

described! {
    named_law Dahl = Info::new::<T, Self>("dahl")
        .summary("elastic contact before sliding, as a function of displacement only")
        .equation("dF/dx = sigma_0 |1 - (F/F_c) sgn(v)|^i sgn(1 - (F/F_c) sgn(v)); + F_v v")
        .source("Dahl 1968, 1977; Cohn 1998, section 2.1.3")
        .limits("no Stribeck effect, no static friction above F_c; inner loops drift");
    F_c;
    sigma_0 = "sigma_0", "N/m", "stiffness at a reversal",
        [1e-2, 1e12], [1e5, 1e6, 1e4] .log();
    exponent = "exponent", "-", "shape of the transition: below 1 ductile, above 1 brittle",
        [0.01, 5.0], [1.0] .log();
    F_v;
}

impl<T: Real> Dahl<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            coulomb_n: p.f_c,
            stiffness_n_m: p.sigma_0,
            exponent: p.exponent,
            viscous_n_s_m: p.f_v,
        }
    }
}

impl<T: Real> Law<T> for Dahl<T> {
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

impl SteadyCurve for Dahl<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self.friction(&0.0, velocity_m_s).along(velocity_m_s.sign()))
    }
}
