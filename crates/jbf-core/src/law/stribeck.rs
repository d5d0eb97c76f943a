//! Stribeck law `F = [F_c + (F_s - F_c) exp(-(|v|/v_s)^delta) + F_v |v|] sgn(v)`.
//!
//! With rising speed, friction falls from its static level, and then grows.
//!
//! Source: Tustin (1947), delta = 1; Bo & Pavelescu (1982), delta 0.5 to 1; Armstrong-Helouvry
//! (1991), delta = 2; Cohn (1998), section 2.2.
//!
//! ```
//! use jbf_core::law::stribeck::{Stribeck, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(Stribeck::new(Parameters { f_c: 4.0, f_s: 6.0, v_s: 0.01, ..Parameters::default() })?);
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

/// Law with a Stribeck curve and without memory.
#[derive(Clone, Copy, Debug)]
pub struct Stribeck<T> {
    coulomb_n: T,
    static_n: T,
    stribeck_m_s: T,
    delta: T,
    viscous_n_s_m: T,
}

described! {
    named_law Stribeck = Info::new::<T, Self>("stribeck")
        .summary("friction that falls from a static level, then grows with speed")
        .equation("F = [F_c + (F_s - F_c) exp(-(|v|/v_s)^delta) + F_v |v|] sgn(v)")
        .source("Tustin 1947; Bo & Pavelescu 1982; Armstrong-Helouvry 1991; Cohn 1998, section 2.2")
        .limits(
            "a curve without memory: equal friction for rising and falling speed; F_s may be \
             below F_c, as for way lubricants",
        )
        .with_a_dry_level();
    F_c;
    F_s;
    v_s;
    delta = "delta", "-", "shape of the decrease: 1 Tustin, 2 Armstrong",
        [0.2, 5.0], [2.0, 1.0] .log();
    F_v;
}

impl<T: Real> Stribeck<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            coulomb_n: p.f_c,
            static_n: p.f_s,
            stribeck_m_s: p.v_s,
            delta: p.delta,
            viscous_n_s_m: p.f_v,
        }
    }
}

impl<T: Real> Law<T> for Stribeck<T> {
    type State = ();

    in_newtons!();

    fn start(&self, _load_n: T) {}

    #[inline(always)]
    fn friction(&self, _state: &(), velocity_m_s: T) -> Friction<T> {
        let share = (velocity_m_s.abs() / self.stribeck_m_s).powf(self.delta);
        let still = (-share).exp();
        Friction {
            jump: self.coulomb_n * (T::ONE - still) + self.static_n * still,
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn advance(&self, _state: &mut (), _speed_m_s: [T; 3], _rate: T, _dt_s: T) {}
}

impl SteadyCurve for Stribeck<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self.friction(&(), velocity_m_s).along(velocity_m_s.sign()))
    }
}
