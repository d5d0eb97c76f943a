//! Harnoy-Friedland model of a journal bearing without the inertia of the journal, equations
//! (3.14), (3.18), (3.19) of Cohn (1998):
//!
//! ```text
//! eps' = (Fb cos(phi) - W + Fb J12 sin(phi)/J11) / (J22 - J12^2/J11)
//! phi' = (J11 eps |Ub|/2 - J12 eps' - Fb sin(phi)) / (J11 eps)
//! W    = K0 (eps - eps_tr)^2 for eps > eps_tr, else 0
//! f    = [ f_m W sgn(U) + gamma (C R/L^2) 2 pi Ub / sqrt(1 - eps^2) ] / Fb
//! ```
//!
//! The state is stored as `x = eps cos(phi)`, `y = eps sin(phi)`, which avoids sine and cosine and
//! has no singularity at the centre of the bearing.
//!
//! Source: Harnoy & Friedland, Tribology Transactions 37 (1994); Cohn, MS thesis, NJIT (1998),
//! chapter 3.
//!
//! ```
//! use jbf_core::law::journal::Journal;
//! use jbf_core::law::journal::Parameters;
//! use jbf_core::{Bearing, Chain, Clock, Motion};
//!
//! let bearing = Bearing::THESIS;
//! let law = Journal::new(&bearing, 104.0, &Parameters::TABLE_4_2, Clock::Journal)?;
//! let chain = Chain::new(law).on(&bearing);
//! let mut state = chain.start(&Motion::at_rest(104.0));
//! let force_n = chain.step_velocity(&mut state, 0.02, 0.002);
//! assert!(force_n > 0.0 && force_n < 0.3 * 104.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

mod build;
pub(crate) mod film_linear;
mod film_motion;
mod film_slopes;
mod named;
mod parameters;
pub(crate) mod side_by_side;
mod state;
mod stribeck;

pub(in crate::law) use named::parts;
pub use parameters::Parameters;
pub(in crate::law) use parameters::{PARAMETERS, SUMMARY};
pub use state::{Loaded, State};

use super::Law;
use crate::clock::Clock;
use crate::film::PI_LESS_8_OVER_PI;
use crate::friction::Friction;
use crate::law::Scales;
use crate::real::Real;
use crate::stepper::{Rk4, Stepper, StiffStepper};
use crate::transition::transition_eccentricity;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
pub(crate) use film_motion::square;
use film_motion::{within, Asperities, Film, Gap};
use nalgebra::Vector2;
use parameters::FILM_PARAMETERS;

/// Attitude angle at the start of a run, rad; its influence decays within a second.
pub(crate) const START_PHI_RAD: f64 = 0.15;

/// Lightest load that the law uses, as a fraction of the load given to its constructor.
///
/// By (3.20) eps_tr falls with the load, to zero for a bearing without load. The asperities would
/// then be in contact at the centre, with a stiffness too high for explicit steps. The model has no
/// meaning there.
const LIGHTEST_SHARE: f64 = 0.01;

/// Friction law of a journal bearing, with precomputed constants.
#[derive(Clone, Copy, Debug)]
pub struct Journal<T> {
    /// Load number `Fb` per newton.
    fb_per_n: T,
    pub(crate) f_m: T,
    pub(crate) k0: T,
    /// Viscous factor `gamma (C R/L^2) 2 pi / U_tr`.
    viscous_s_m: T,
    pub(crate) inverse_u_tr: T,
    /// Dimensionless time per second.
    pub(crate) rate: T,
    /// Load number and eps_tr for the load given to the constructor, stored so that a start needs
    /// no computation.
    nominal: Loaded<T>,
    clock: Clock,
}

impl<T: Real> Journal<T> {
    /// Returns the load number and the transition eccentricity for a load (N), which is at least
    /// [`LIGHTEST_SHARE`] of the nominal load.
    pub(crate) fn under(&self, load_n: T) -> Loaded<T> {
        if load_n == self.nominal.load_n {
            return self.nominal;
        }
        let load_number = self.fb_per_n * self.pressed_n(load_n);
        // Under a heavy load eps_tr rounds to one in single precision, which is outside the
        // bearing.
        let eps_tr = transition_eccentricity(load_number).min(T::EPS_LIMIT);
        Loaded {
            load_n,
            load_number,
            inverse_load_number: T::ONE / load_number,
            eps_tr,
        }
    }

    /// Returns the load number and the transition eccentricity for the load given to the
    /// constructor.
    pub fn nominal(&self) -> Loaded<T> {
        self.nominal
    }

    /// Returns the asperity model for a load.
    #[inline(always)]
    fn asperities(&self, loaded: &Loaded<T>) -> Asperities<T> {
        Asperities {
            k0: self.k0,
            eps_tr: loaded.eps_tr,
            part: true,
        }
    }

    /// Asperity load `W = K0 (eps - eps_tr)^2`, zero below eps_tr.
    #[inline(always)]
    pub(crate) fn asperity_load(&self, eps: T, eps_tr: T) -> T {
        let (k0, part) = (self.k0, true);
        Asperities { k0, eps_tr, part }.load(eps)
    }

    /// Friction coefficient, equation (3.14) of Cohn (1998), at a speed (m/s, signed) and an
    /// eccentricity ratio, given by its square `e2`.
    #[inline(always)]
    pub(crate) fn sliding(&self, loaded: &Loaded<T>, e2: T, velocity_m_s: T) -> Friction<T> {
        let asperities = self.asperities(loaded);
        let per_load = loaded.inverse_load_number;
        if T::HAS_SLOPES {
            let (f_m, viscous_s_m) = (self.f_m, self.viscous_s_m);
            return film_slopes::sliding(
                [f_m, viscous_s_m, per_load],
                &asperities,
                e2,
                velocity_m_s,
            );
        }
        let gap = Gap::at(e2);
        Friction {
            jump: self.f_m * per_load * asperities.load(gap.e),
            smooth: self.viscous_s_m * per_load * velocity_m_s * gap.inverse_root(),
        }
    }

    /// Advances the film by one step with any explicit method; [`Law::advance`] uses Runge-Kutta.
    #[inline]
    pub fn advance_with<S: Stepper>(
        &self,
        stepper: &S,
        state: &mut State<T>,
        speed_m_s: [T; 3],
        rate: T,
        dt_s: T,
    ) {
        self.advance_inline(stepper, state, speed_m_s, rate, dt_s);
    }

    /// Advances the film by one step with any explicit method, always inlined.
    ///
    /// It is [`Journal::advance_with`] for loops that are compiled for a wider instruction set.
    #[doc(hidden)]
    #[inline(always)]
    pub fn advance_inline<S: Stepper>(
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
            from: state.xy,
            from_e2: state.e2,
        };
        let ub = speed_m_s.map(|u| u * self.inverse_u_tr);
        // Minus zero is the neutral start of a sum: `-0.0 + x` is exactly `x`.
        let mut way = Vector2::repeat(-T::ZERO);
        stepper.step(&film, &mut way, ub, dt_s * rate * self.rate);
        self.moved(state, way);
    }

    /// Advances the film by one step with any implicit method.
    #[inline]
    pub fn advance_stiff_with<S: StiffStepper>(
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
            from: state.xy,
            from_e2: state.e2,
        };
        let ub = speed_m_s.map(|u| u * self.inverse_u_tr);
        let mut way = Vector2::repeat(-T::ZERO);
        stepper.step(&film, &mut way, ub, dt_s * rate * self.rate);
        self.moved(state, way);
    }

    /// Stores the position after the displacement `way`, limited to the inside of the bearing.
    #[inline(always)]
    fn moved(&self, state: &mut State<T>, way: Vector2<T>) {
        let way = way + state.kept;
        let xy = state.xy + way;
        let e2 = square(&xy);
        let limit = T::EPS_LIMIT * T::EPS_LIMIT;
        if T::SIDE_BY_SIDE {
            state.clamped |= u32::from(!within(e2));
        }
        if T::SIDE_BY_SIDE || e2 <= limit {
            // Compensated summation (Kahan 1965): the rounding error of this sum enters the next.
            // By components: assembling the vector first takes five instructions more.
            state.kept.x = way.x - (xy.x - state.xy.x);
            state.kept.y = way.y - (xy.y - state.xy.y);
            (state.xy, state.e2) = (xy, e2);
            return;
        }
        // The step was too coarse. A step without finite values leaves the film unchanged; any
        // other is limited in its direction.
        state.clamped = state.clamped.saturating_add(1);
        if e2.is_finite() {
            let shrink = self.deepest(&state.loaded) / e2.sqrt();
            state.put(xy * shrink);
        }
    }

    /// Eccentricity ratio to which the journal is limited after a step that was too coarse.
    ///
    /// It is that of a journal at rest, whose asperities carry the whole load. If that is too deep
    /// (soft asperities), it is nine tenths of the distance from eps_tr to the wall. Closer to the
    /// wall, the film hardly flows, and the journal would remain there for hours.
    pub(crate) fn deepest(&self, loaded: &Loaded<T>) -> T {
        let at_rest = loaded.eps_tr + (loaded.load_number / self.k0).sqrt();
        let near_wall = loaded.eps_tr + (T::ONE - loaded.eps_tr) * T::of(0.9);
        at_rest.min(near_wall).min(T::EPS_LIMIT)
    }
}

impl<T: Real> Law<T> for Journal<T> {
    type State = State<T>;

    const FILM_PARAMETERS: Option<[usize; 2]> = Some(FILM_PARAMETERS);

    /// Returns the square of the eccentricity ratio.
    #[inline(always)]
    fn film(&self, state: &State<T>) -> T {
        state.e2
    }

    #[inline(always)]
    fn put_film(&self, state: &mut State<T>, film: T) {
        state.e2 = film;
    }

    fn start(&self, load_n: T) -> State<T> {
        let loaded = self.under(load_n);
        State::at(loaded.eps_tr, T::of(START_PHI_RAD), loaded)
    }

    fn longest_step_s(&self, top_speed_m_s: f64) -> f64 {
        // The fastest rates of the film, 1/s, at eps_tr. They are those of the oil carried round
        // with the shaft, about four times U/R, of the load that squeezes the film, and of the
        // asperities' push.
        let loaded = self.nominal;
        let (rate, fb) = (self.rate.value(), loaded.load_number.value());
        let ub = libm::fabs(top_speed_m_s * self.inverse_u_tr.value());
        let e = loaded.eps_tr.value();
        let d = (1.0 - e) * (1.0 + e);
        let d32 = d * crate::root::sqrt(d);
        let squeezing = FRAC_2_PI * fb * d32;
        let stiffness = 2.0 * crate::root::sqrt(fb * self.k0.value());
        let pushing = stiffness * d32 * d / (FRAC_PI_2 + PI_LESS_8_OVER_PI);
        // Runge-Kutta is stable up to 2.8 times the inverse of a rate, and accurate well below it.
        1.0 / (rate * (4.0 * ub + squeezing + pushing))
    }

    #[inline(always)]
    fn pressed_n(&self, load_n: T) -> T {
        load_n.max(self.nominal.load_n * T::of(LIGHTEST_SHARE))
    }

    #[inline(always)]
    fn load_share(&self, load_n: T) -> T {
        self.pressed_n(load_n) / self.nominal.load_n
    }

    /// Returns the law with U_tr and K0 multiplied by the scales of the present load.
    ///
    /// The scales are one at the nominal load, so the precomputed values for this load remain
    /// valid.
    #[inline(always)]
    fn scaled(&self, scales: &Scales<T>) -> Option<Self> {
        let slower = T::ONE / scales.transition_speed;
        let rate = match self.clock {
            Clock::Journal => self.rate * scales.transition_speed,
            Clock::Thesis => self.rate,
        };
        Some(Self {
            fb_per_n: self.fb_per_n * slower,
            k0: self.k0 * scales.stiffness,
            viscous_s_m: self.viscous_s_m * slower,
            inverse_u_tr: self.inverse_u_tr * slower,
            rate,
            ..*self
        })
    }

    #[inline(always)]
    fn set_load(&self, state: &mut State<T>, load_n: T) {
        if load_n != state.loaded.load_n {
            state.loaded = self.under(load_n);
        }
    }

    #[inline(always)]
    fn friction(&self, state: &State<T>, velocity_m_s: T) -> Friction<T> {
        // Uses the same `e2` as the slope, so that a step and its friction share roots and
        // division.
        self.sliding(&state.loaded, state.e2, velocity_m_s)
    }

    #[inline(always)]
    fn advance(&self, state: &mut State<T>, speed_m_s: [T; 3], rate: T, dt_s: T) {
        self.advance_inline(&Rk4, state, speed_m_s, rate, dt_s);
    }
}
