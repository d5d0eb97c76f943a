//! Coulomb friction: `F = (F_c + F_v |v|) sgn(v)` in motion, `|F| <= F_s` at rest.
//!
//! Source: Coulomb (1785); Morin (1833) for static friction; Reynolds (1886) for the viscous part;
//! Cohn (1998), section 2.1.1.
//!
//! Static friction is set-valued: it acts while the journal *stays* at rest under the force of an
//! elastic element, such as a compliant drive (`drive_compliance`). The journal then sticks up to
//! `F_s` and slides with `F_c`. With a rigid drive, which imposes the speed, the friction at rest
//! is undetermined and breakaway takes no time. `F_s` is then not identifiable, and a fit holds it
//! constant. A reversal without a stop is not a rest.
//!
//! ```
//! use jbf_core::law::coulomb::{Coulomb, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(Coulomb::new(Parameters { f_c: 4.0, f_s: 6.0, f_v: 10.0 })?);
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

/// Law with static, kinetic and viscous friction.
#[derive(Clone, Copy, Debug)]
pub struct Coulomb<T> {
    kinetic_n: T,
    static_n: T,
    viscous_n_s_m: T,
}

described! {
    named_law Coulomb = Info::new::<T, Self>("coulomb")
        .summary("static, Coulomb and viscous friction")
        .equation("F = (F_c + F_v |v|) sgn(v); |F| <= F_s at rest")
        .source("Coulomb 1785; Morin 1833; Reynolds 1886; Cohn 1998, section 2.1.1")
        .limits(
            "no memory, no decrease of friction with speed; F_s is visible only with an \
                 elastic drive",
        )
        .with_a_dry_level();
    F_c;
    F_s;
    F_v;
}

impl<T: Real> Coulomb<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            kinetic_n: p.f_c,
            static_n: p.f_s,
            viscous_n_s_m: p.f_v,
        }
    }
}

impl<T: Real> Law<T> for Coulomb<T> {
    /// True while the journal has been at rest for a whole step.
    type State = bool;

    const HAS_MEMORY: bool = false;
    const HAS_STATIC_LEVEL: bool = true;

    in_newtons!();

    fn start(&self, _load_n: T) -> bool {
        true
    }

    #[inline(always)]
    fn friction(&self, resting: &bool, velocity_m_s: T) -> Friction<T> {
        let held = *resting && velocity_m_s == T::ZERO;
        Friction {
            jump: if held { self.static_n } else { self.kinetic_n },
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn advance(&self, resting: &mut bool, speed_m_s: [T; 3], _rate: T, _dt_s: T) {
        *resting = speed_m_s.iter().all(|&v| v == T::ZERO);
    }
}

impl SteadyCurve for Coulomb<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        Ok(self
            .friction(&false, velocity_m_s)
            .along(velocity_m_s.sign()))
    }
}
