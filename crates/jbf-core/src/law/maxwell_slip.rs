//! Maxwell slip law: parallel springs, each of which slips at its own fraction of the friction
//! level.
//!
//! ```text
//! F = sum F_j + F_v v,   dF_j/dx = k_j  while |F_j| < a_j F_c,   F_j = a_j F_c sgn(v)  beyond
//! ```
//!
//! Source: Iwan (1966) for the elements; Lampaert, Swevers & Al-Bender (2003) and Al-Bender,
//! Lampaert & Swevers (2005). In their generalised form (GMS), the friction level falls with the
//! speed; here, the effect `stribeck_excess` describes this fall, and `dry_load_dependence` a level
//! that grows with the load. Both change F_c; the elements keep their stiffness and their fractions
//! of F_c.
//!
//! Each element stores its last reversal, so the force obeys Masing's rules (1926). A branch after
//! a reversal is the virgin curve enlarged by a factor of two. An inner loop closes, and the force
//! then continues as if the loop had not occurred. The laws of Dahl and LuGre have one state only,
//! and drift in an inner loop.
//!
//! A record does not determine all stiffnesses and fractions, and permutations of them are
//! equivalent. A record does determine the stiffness at a reversal, `sigma_0`, and the shape of the
//! virgin curve. The elements therefore approximate the virgin curve of Dahl's law, with its
//! parameters,
//!
//! ```text
//! F(x) = F_c [1 - (1 - (1 - i) sigma_0 x/F_c)^(1/(1 - i))]
//! ```
//!
//! The exponent i covers the known contacts. As i approaches 0, all elements slip at once (elastic,
//! then plastic). The value 1/3 is that of a sphere on a plane (Cattaneo 1938; Mindlin 1949). For
//! 1/2, the slip displacements are distributed uniformly (Iwan); for 1, the curve is exponential.
//!
//! While x grows, the fraction u of the stiffness that still sticks falls. The springs that make up
//! the fraction u and slip last carry `g(u) = (u - i u^(1/i))/(1 - i)` of F_c. An element is the
//! interval between two values of u.
//!
//! The law is rate-independent: a sticking element is a spring and a sliding one is at its level. A
//! step in one direction is therefore exact and stable for any length.
//!
//! ```
//! use jbf_core::law::maxwell_slip::{MaxwellSlip, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(MaxwellSlip::new(Parameters { f_c: 4.0, sigma_0: 1e5, ..Parameters::default() })?);
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
use crate::motion::JournalMotion;
use crate::path::{legs, Leg};
use crate::real::Real;

/// Number of elements (parallel springs).
///
/// With 16 elements, the error relative to the virgin curve is 0.8 % of F_c at i = 0.1, 0.2 % at
/// 1/2, and 0.6 % at 1.
pub(crate) const ELEMENTS: usize = 16;

/// Law with parallel springs that slip one after the other.
#[derive(Clone, Copy, Debug)]
pub struct MaxwellSlip<T> {
    coulomb_n: T,
    viscous_n_s_m: T,
    /// Stiffness of each element, N/m.
    stiffness_n_m: [T; ELEMENTS],
    /// Fraction of the friction level that each element carries.
    share: [T; ELEMENTS],
}

/// Cumulative fractions of the stiffness at the borders between the elements.
///
/// The borders are close together where the last elements of a brittle curve slip.
fn borders() -> [f64; ELEMENTS + 1] {
    core::array::from_fn(|j| {
        let part = j as f64 / ELEMENTS as f64;
        part * libm::sqrt(part)
    })
}

/// Function `g(u) = (u - i u^(1/i))/(1 - i)`, the fraction of F_c that the last springs to slip
/// carry, continuous at i = 1.
fn carried<T: Real>(u: f64, exponent: T) -> T {
    if u <= 0.0 {
        return T::ZERO;
    }
    let log = T::of(libm::log(u));
    let x = (T::ONE - exponent) / exponent * log;
    // (e^x - 1)/x, by its series where it would be zero over zero.
    let mean = if x.value().abs() < 1e-2 {
        let of = |k: f64| T::of(1.0 / k);
        T::ONE + x * (of(2.0) + x * (of(6.0) + x * (of(24.0) + x * (of(120.0) + x * of(720.0)))))
    } else {
        x.exp_m1() / x
    };
    T::of(u) * (T::ONE - log * mean)
}

impl<T: Real> MaxwellSlip<T> {
    /// Returns the stiffness (N/m) and the friction level (N) of each element.
    pub fn elements(&self) -> [[T; 2]; ELEMENTS] {
        core::array::from_fn(|j| [self.stiffness_n_m[j], self.share[j] * self.coulomb_n])
    }

    /// Advances the forces of all elements along one leg, a part of a step in one direction.
    #[inline(always)]
    fn slide(&self, forces_n: &mut [T; ELEMENTS], leg: &Leg<T>) {
        let way = leg.direction * leg.distance_m;
        let level = leg.level[1].max(T::ZERO);
        let elements = self.stiffness_n_m.iter().zip(&self.share);
        for (force, (&stiffness, &share)) in forces_n.iter_mut().zip(elements) {
            let (bent, most) = (*force + stiffness * way, share * level);
            *force = if bent > most {
                most
            } else if bent < -most {
                -most
            } else {
                bent
            };
        }
    }

    /// Forces of all elements in sliding, in the direction of motion, N.
    fn sliding(&self, level: T, direction: T) -> [T; ELEMENTS] {
        self.share.map(|share| share * level * direction)
    }
}

/// Total force of all elements, N.
#[inline(always)]
fn sum<T: Real>(forces_n: &[T; ELEMENTS]) -> T {
    forces_n.iter().fold(T::ZERO, |sum, &force| sum + force)
}

described! {
    named_law MaxwellSlip = Info::new::<T, Self>("maxwell_slip")
        .summary(
            "parallel spring-slider elements: presliding with nonlocal memory of all \
                  reversals",
        )
        .equation(
            "F = sum F_j + F_v v, dF_j/dx = k_j up to |F_j| = a_j F_c; virgin curve \
                   F_c (1 - (1 - (1 - i) sigma_0 x/F_c)^(1/(1 - i)))",
        )
        .source("Iwan 1966; Lampaert, Swevers & Al-Bender 2003; Al-Bender et al. 2005")
        .limits("no Stribeck effect of its own; no frictional lag in sliding");
    F_c;
    sigma_0 = "sigma_0", "N/m", "stiffness at a reversal",
        [1e-2, 1e12], [1e5, 1e6, 1e4] .log();
    exponent = "exponent", "-", "shape of the transition: near 0 all slip at once, 1/3 a sphere, 1 an exponential",
        [0.01, 2.0], [0.5, 0.1] .log();
    F_v;
}

impl<T: Real> MaxwellSlip<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        let (whole, exponent) = (p.sigma_0, p.exponent);
        let border = borders();
        Self {
            coulomb_n: p.f_c,
            viscous_n_s_m: p.f_v,
            stiffness_n_m: core::array::from_fn(|j| whole * T::of(border[j + 1] - border[j])),
            share: core::array::from_fn(|j| {
                carried(border[j + 1], exponent) - carried(border[j], exponent)
            }),
        }
    }
}

impl<T: Real> Law<T> for MaxwellSlip<T> {
    /// Force of each element, N.
    type State = [T; ELEMENTS];

    const HAS_BRISTLE: bool = true;

    in_newtons!();

    fn start(&self, _load_n: T) -> [T; ELEMENTS] {
        [T::ZERO; ELEMENTS]
    }

    #[inline(always)]
    fn friction(&self, _state: &[T; ELEMENTS], velocity_m_s: T) -> Friction<T> {
        Friction {
            jump: self.coulomb_n,
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        f64::INFINITY
    }

    #[inline(always)]
    fn advance(&self, _state: &mut [T; ELEMENTS], _speed_m_s: [T; 3], _rate: T, _dt_s: T) {}

    #[inline(always)]
    fn bend(
        &self,
        state: &mut [T; ELEMENTS],
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        if dt_s.value() <= 0.0 {
            *state = self.sliding(level[1], to.velocity_m_s.sign());
            return sum(state);
        }
        let turning = |_| (level[0] + level[1]) * T::of(0.5);
        for leg in legs(from, to, level, turning, dt_s).iter().flatten() {
            self.slide(state, leg);
        }
        sum(state)
    }
}

impl SteadyCurve for MaxwellSlip<f64> {
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        let forces = [0.0; ELEMENTS];
        Ok(self
            .friction(&forces, velocity_m_s)
            .along(velocity_m_s.sign()))
    }
}
