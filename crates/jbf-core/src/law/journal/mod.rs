//! The reduced Harnoy-Friedland model of a journal bearing, equations (3.14), (3.18), (3.19):
//!
//! ```text
//! eps' = (Fb cos(phi) - W + Fb J12 sin(phi)/J11) / (J22 - J12^2/J11)
//! phi' = (J11 eps |Ub|/2 - J12 eps' - Fb sin(phi)) / (J11 eps)
//! W    = K0 (eps - eps_tr)^2 for eps > eps_tr, else 0
//! f    = [ f_m W sgn(U) + gamma (C R/L^2) 2 pi Ub / sqrt(1 - eps^2) ] / Fb
//! ```
//!
//! The state is held as `x = eps cos(phi)`, `y = eps sin(phi)`: no sine, no cosine, and no
//! singularity at the centre of the bearing.
//!
//! Source: Harnoy & Friedland, ASLE Trans. 37 (1994); Cohn, MS thesis, NJIT (1998), chapter 3.

mod film_motion;
mod parameters;
mod state;

pub use parameters::{k0_from_original, Parameters, PARAMETERS, SUMMARY};
pub use state::{Loaded, State};

use super::{pressed_n, Law, Sliding, Steady};
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::{check, positive, ParameterError};
use crate::real::Real;
use crate::stepper::{Rk4, Stepper};
use crate::transition::transition_eccentricity;
use core::f64::consts::PI;
use film_motion::Film;

/// Attitude angle at which a run starts, rad. The film forgets it within a second.
pub const START_PHI_RAD: f64 = 0.15;

/// The law, ready to step.
#[derive(Clone, Copy, Debug)]
pub struct Journal<T> {
    /// `Fb` of one newton.
    fb_per_n: T,
    f_m: T,
    k0: T,
    /// `gamma (C R/L^2) 2 pi / U_tr`.
    viscous_s_m: T,
    inverse_u_tr: T,
    /// Dimensionless time per second.
    rate: T,
    /// The load of the constructor and its eps_tr, so that a start costs nothing.
    nominal: Loaded<T>,
}

impl<T: Real> Journal<T> {
    /// Check the numbers once and fold the constants together.
    ///
    /// # Errors
    /// Names the first number that is not positive and finite.
    pub fn new(
        bearing: &Bearing,
        load_n: f64,
        parameters: &Parameters<T>,
        clock: Clock,
    ) -> Result<Self, ParameterError> {
        let bearing = bearing.checked()?;
        positive("load_n", load_n)?;
        let p = parameters;
        check(
            p.f_m.is_finite() && p.f_m >= T::ZERO,
            "f_m",
            p.f_m.value(),
            "must be zero or positive, and finite",
        )?;
        positive("U_tr_m_s", p.u_tr_m_s.value())?;
        positive("K0", p.k0.value())?;
        check(
            p.gamma.is_finite() && p.gamma >= T::ZERO,
            "gamma",
            p.gamma.value(),
            "must be zero or positive, and finite",
        )?;
        let fb_per_n = bearing.load_number(T::ONE, p.u_tr_m_s);
        let mut law = Self {
            fb_per_n,
            f_m: p.f_m,
            k0: p.k0,
            viscous_s_m: p.gamma * T::of(bearing.viscous_ratio() * 2.0 * PI) / p.u_tr_m_s,
            inverse_u_tr: T::ONE / p.u_tr_m_s,
            rate: match clock {
                Clock::Journal => p.u_tr_m_s * T::of(1.0 / bearing.radius_m),
                Clock::Thesis => T::ONE,
            },
            nominal: Loaded {
                load_n: T::ZERO,
                load_number: T::ZERO,
                eps_tr: T::ZERO,
            },
        };
        law.nominal = law.under(T::of(load_n));
        // Sizes in the wrong unit overflow here, and would step as infinities.
        let folded = [law.viscous_s_m, law.inverse_u_tr, law.rate]
            .iter()
            .all(|x| x.is_finite());
        let load_number = law.nominal.load_number;
        check(
            folded && load_number > T::ZERO && load_number.is_finite(),
            "load_number",
            load_number.value(),
            "or another group of the sizes overflows: check their units",
        )?;
        Ok(law)
    }

    /// The same law with a transition eccentricity given instead of solved from (3.20), for
    /// reproducing the printed tables.
    ///
    /// # Errors
    /// `eps_tr` must lie between 0 and 1.
    pub fn with_eps_tr(mut self, eps_tr: f64) -> Result<Self, ParameterError> {
        check(
            eps_tr > 0.0 && eps_tr < 1.0,
            "eps_tr",
            eps_tr,
            "must lie between 0 and 1",
        )?;
        self.nominal.eps_tr = T::of(eps_tr);
        Ok(self)
    }

    /// Load number and transition eccentricity under a load; a load that does not press is
    /// taken as [`super::LIGHTEST_LOAD_N`].
    pub fn under(&self, load_n: T) -> Loaded<T> {
        if load_n.value() == self.nominal.load_n.value() {
            return self.nominal;
        }
        let load_number = self.fb_per_n * pressed_n(load_n);
        // A heavy load in single precision rounds eps_tr to one: outside the bearing.
        let eps_tr = transition_eccentricity(load_number).min(T::EPS_LIMIT);
        Loaded {
            load_n,
            load_number,
            eps_tr,
        }
    }

    /// What the constructor's load gave.
    pub fn nominal(&self) -> Loaded<T> {
        self.nominal
    }

    /// Asperity load `W = K0 (eps - eps_tr)^2`, zero below eps_tr.
    #[inline]
    fn asperity_load(&self, eps: T, eps_tr: T) -> T {
        let touch = (eps - eps_tr).max(T::ZERO);
        self.k0 * touch * touch
    }

    /// Friction coefficient at an eccentricity ratio and a speed, (3.14).
    #[inline]
    fn sliding(&self, loaded: &Loaded<T>, eps: T, velocity_m_s: T) -> Sliding<T> {
        let d = (T::ONE - eps) * (T::ONE + eps);
        let inverse_load = T::ONE / loaded.load_number;
        Sliding {
            level: self.f_m * self.asperity_load(eps, loaded.eps_tr) * inverse_load,
            viscous: self.viscous_s_m * velocity_m_s * inverse_load / d.sqrt(),
        }
    }

    /// One step with any explicit stepper; [`Law::advance`] uses Runge-Kutta.
    #[inline]
    pub fn advance_with<S: Stepper>(
        &self,
        stepper: &S,
        state: &mut State<T>,
        speed_m_s: [T; 3],
        rate: T,
        dt_s: T,
    ) {
        let film = Film {
            law: self,
            loaded: &state.loaded,
        };
        let ub = speed_m_s.map(|u| u * self.inverse_u_tr);
        let mut xy = state.xy;
        stepper.step(&film, &mut xy, ub, dt_s * rate * self.rate);
        let e2 = xy[0] * xy[0] + xy[1] * xy[1];
        let limit = T::EPS_LIMIT;
        if e2.value() <= (limit * limit).value() {
            state.xy = xy;
            return;
        }
        state.clamped = state.clamped.saturating_add(1);
        // Too coarse a step: hold the journal just inside the bearing, on the same side.
        // A step that lost its numbers altogether leaves the film as it was.
        if e2.is_finite() {
            let shrink = limit / e2.sqrt();
            state.xy = [xy[0] * shrink, xy[1] * shrink];
        }
    }
}

impl<T: Real> Law<T> for Journal<T> {
    type State = State<T>;

    fn start(&self, load_n: T) -> State<T> {
        let loaded = self.under(load_n);
        State::at(loaded.eps_tr, T::of(START_PHI_RAD), loaded)
    }

    #[inline]
    fn set_load(&self, state: &mut State<T>, load_n: T) {
        if load_n.value() != state.loaded.load_n.value() {
            state.loaded = self.under(load_n);
        }
    }

    #[inline]
    fn friction(&self, state: &State<T>, velocity_m_s: T) -> Sliding<T> {
        self.sliding(&state.loaded, state.eps(), velocity_m_s)
    }

    #[inline]
    fn advance(&self, state: &mut State<T>, speed_m_s: [T; 3], rate: T, dt_s: T) {
        self.advance_with(&Rk4, state, speed_m_s, rate, dt_s);
    }
}

impl Journal<f64> {
    /// Steady eccentricity, attitude and friction at a speed (m/s, signed), (3.5), (3.6).
    ///
    /// # Errors
    /// The speed must be finite and not zero: at rest the friction is set-valued.
    pub fn steady(&self, velocity_m_s: f64) -> Result<Steady, ParameterError> {
        check(
            velocity_m_s.is_finite() && velocity_m_s != 0.0,
            "velocity_m_s",
            velocity_m_s,
            "must be finite and not zero",
        )?;
        let ub = libm::fabs(velocity_m_s) * self.inverse_u_tr;
        let loaded = &self.nominal;
        let (eps, phi_rad) = super::steady::solve(loaded.load_number, ub, |eps| {
            self.asperity_load(eps, loaded.eps_tr)
        });
        let coefficient = self
            .sliding(loaded, eps, velocity_m_s)
            .coefficient(velocity_m_s.sign());
        Ok(Steady {
            eps,
            phi_rad,
            coefficient,
        })
    }
}
