//! Harnoy-Friedland model of a journal bearing with the inertia of the journal.
//!
//! Equations (3.7), (3.8) and (3.14) of Cohn (1998); a dot is d/d(tbar):
//!
//! ```text
//! mb eps''     = Fb cos(phi) - W + J12 eps |Ub|/2 - J12 eps phi' - J22 eps' + mb eps phi'^2
//! mb eps phi'' = -Fb sin(phi) + J11 eps |Ub|/2 - J11 eps phi' - J12 eps' - 2 mb eps' phi'
//! ```
//!
//! These equations are Newton's second law in polar coordinates; the two terms in `mb phi'` are
//! those of an acceleration in a rotating frame. With `r = (eps cos(phi), eps sin(phi))` and the
//! load along x they become
//!
//! ```text
//! mb r'' = Fb x - W r/eps - D (r' - (|Ub|/2) z cross r),   D = [ J22  J12 ]  in the frame of r,
//!                                                              [ J12  J11 ]
//! ```
//!
//! which is the form in `motion.rs` (an independent derivation confirmed the printed equations). The
//! state is `(x, y)` and its time derivative, not eps and phi, for these reasons:
//!
//! - A step has no sine or cosine.
//! - There is no singularity at the centre.
//! - There are no terms in `mb phi'` that would couple the fast variables.
//! - `D` stays symmetric and positive. The linear system of an implicit step, `mb s I + D + K/s`,
//!   then has good pivots for every mass, down to zero. Here `s` is of the order of the inverse
//!   step and `K` is the stiffness of film and asperities.
//!
//! The velocity relaxes to that of the model without inertia within `mb/J11`, about ten
//! microseconds, and an explicit step would have to be shorter. [`Law::advance`] uses [`Rodas3`].
//!
//! Source: Harnoy & Friedland, Tribology Transactions 37 (1994); Cohn, MS thesis, NJIT (1998),
//! chapter 3.
//!
//! ```
//! use jbf_core::law::journal_full::JournalFull;
//! use jbf_core::law::journal::Parameters;
//! use jbf_core::{Bearing, Chain, Clock, Motion};
//!
//! let bearing = Bearing::THESIS;
//! let law = JournalFull::new(&bearing, 104.0, &Parameters::TABLE_4_2, Clock::Journal)?;
//! let chain = Chain::new(law).on(&bearing);
//! let mut state = chain.start(&Motion::at_rest(104.0));
//! let force_n = chain.step_velocity(&mut state, 0.02, 0.002);
//! assert!(force_n > 0.0 && force_n < 0.3 * 104.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

mod build;
pub(crate) mod motion;
mod named;
mod state;

pub use state::State;

use super::journal::{square, Journal, Loaded, START_PHI_RAD};
use super::Law;
use crate::friction::Friction;
use crate::law::Scales;
use crate::real::Real;
use crate::stepper::{Rodas3, StiffStepper};
use motion::FullFilm;
use nalgebra::{Vector2, Vector4};

/// Fractions at which a step is divided into three while the velocity relaxes to that of the film:
/// at a start and after a jump of the load.
///
/// In one step of 2 ms, the error of the relaxation would be 2e-4 of the peak of the friction; in
/// three steps, it is 6e-7.
const CUTS: [f64; 2] = [0.05, 0.2];

/// Relative change of the load in one step from which it is treated as a jump.
const JUMP: f64 = 0.01;

/// Friction law of a journal bearing with the inertia of the journal, with precomputed constants.
///
/// The parameters are those of [`Journal`]; the mass is that of the bearing.
#[derive(Clone, Copy, Debug)]
pub struct JournalFull<T> {
    pub(crate) film: Journal<T>,
    inverse_mass_number: T,
}

impl<T: Real> JournalFull<T> {
    /// Returns the law without the inertia of the journal.
    pub fn reduced(&self) -> &Journal<T> {
        &self.film
    }

    /// Advances the film by one step with any implicit method; [`Law::advance`] uses [`Rodas3`].
    #[inline]
    pub fn advance_with<S: StiffStepper>(
        &self,
        stepper: &S,
        state: &mut State<T>,
        speed_m_s: [T; 3],
        rate: T,
        dt_s: T,
    ) {
        if !state.fresh {
            return self.once(stepper, state, speed_m_s, rate, dt_s);
        }
        state.fresh = false;
        let [start, middle, end] = speed_m_s;
        let speed_at = |s: f64| {
            if s < 0.5 {
                start + (middle - start) * T::of(2.0 * s)
            } else {
                middle + (end - middle) * T::of(2.0 * s - 1.0)
            }
        };
        for (from, to) in [(0.0, CUTS[0]), (CUTS[0], CUTS[1]), (CUTS[1], 1.0)] {
            let speeds = [from, 0.5 * (from + to), to].map(speed_at);
            self.once(stepper, state, speeds, rate, dt_s * T::of(to - from));
        }
    }

    fn once<S: StiffStepper>(
        &self,
        stepper: &S,
        state: &mut State<T>,
        speed_m_s: [T; 3],
        rate: T,
        dt_s: T,
    ) {
        let film = FullFilm::held(self, &state.loaded, state.xy);
        let ub = speed_m_s.map(|u| u * self.film.inverse_u_tr);
        let (kept, velocity) = (state.kept, state.velocity);
        let mut way = Vector4::new(kept.x, kept.y, velocity.x, velocity.y);
        stepper.step(&film, &mut way, ub, dt_s * rate * self.film.rate);
        let xy = Vector2::new(state.xy.x + way.x, state.xy.y + way.y);
        let e2 = square(&xy);
        let sound = e2.is_finite() && way.z.is_finite() && way.w.is_finite();
        let limit = T::EPS_LIMIT;
        if sound && e2.value() <= (limit * limit).value() {
            // Compensated summation (Kahan 1965): the rounding error of this sum enters the next.
            // By components: assembling the vectors first takes more instructions.
            state.kept.x = way.x - (xy.x - state.xy.x);
            state.kept.y = way.y - (xy.y - state.xy.y);
            state.xy = xy;
            state.velocity.x = way.z;
            state.velocity.y = way.w;
            return;
        }
        // The step was too coarse. A step without finite values leaves the film unchanged; any
        // other is limited in its direction. The film adopts any velocity immediately, so the
        // velocity is reset.
        state.clamped = state.clamped.saturating_add(1);
        state.velocity = Vector2::zeros();
        if sound {
            let shrink = self.film.deepest(&state.loaded) / e2.sqrt();
            state.xy = xy * shrink;
            state.kept = Vector2::zeros();
        }
    }

    /// Returns the load number and the transition eccentricity for a load (N), as
    /// [`Journal::under`].
    pub(crate) fn under(&self, load_n: T) -> Loaded<T> {
        self.film.under(load_n)
    }
}

impl<T: Real> Law<T> for JournalFull<T> {
    type State = State<T>;

    fn start(&self, load_n: T) -> State<T> {
        let loaded = self.under(load_n);
        State::at(loaded.eps_tr, T::of(START_PHI_RAD), loaded)
    }

    /// Longest step with which the film is accurate, s; the implicit method is stable with any
    /// step.
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64 {
        self.film.longest_step_s(top_speed_m_s)
    }

    #[inline]
    fn pressed_n(&self, load_n: T) -> T {
        self.film.pressed_n(load_n)
    }

    #[inline]
    fn load_share(&self, load_n: T) -> T {
        self.film.load_share(load_n)
    }

    /// Returns the law with scaled parameters; the mass number is proportional to U_tr.
    #[inline]
    fn scaled(&self, scales: &Scales<T>) -> Option<Self> {
        Some(Self {
            film: self.film.scaled(scales)?,
            inverse_mass_number: self.inverse_mass_number / scales.transition_speed,
        })
    }

    #[inline]
    fn set_load(&self, state: &mut State<T>, load_n: T) {
        let before = state.loaded.load_n;
        if load_n.value() != before.value() {
            state.fresh |= (load_n - before).abs() > before.abs() * T::of(JUMP);
            state.loaded = self.under(load_n);
        }
    }

    #[inline]
    fn friction(&self, state: &State<T>, velocity_m_s: T) -> Friction<T> {
        self.film
            .sliding(&state.loaded, square(&state.xy), velocity_m_s)
    }

    #[inline]
    fn advance(&self, state: &mut State<T>, speed_m_s: [T; 3], rate: T, dt_s: T) {
        self.advance_with(&Rodas3, state, speed_m_s, rate, dt_s);
    }
}
