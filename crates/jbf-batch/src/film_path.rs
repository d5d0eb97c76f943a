//! Stored eccentricity of a film along a record.
//!
//! The film depends on the motion and on two parameters of the law only, and not on later stages of
//! the signal chain. Chains that differ only in later stages therefore need not integrate the film
//! again.
//!
//! [`FilmSteps`] is a law that reports the steps that a record requires of a film. [`OnPath`] is a
//! law whose film takes its states from a list. With the states that belong to its parameters, the
//! results are identical bit for bit to an integration.

use jbf_core::law::Law;
use jbf_core::JournalMotion;
use jbf_core::{Friction, Real};

/// State of the film at the end of a step, with its derivatives with respect to the two film
/// parameters of the law.
///
/// See [`Law::film`] and [`Law::FILM_PARAMETERS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// State of the film: the square of the eccentricity ratio for a journal law.
    pub film: f64,
    /// Derivatives of the state, in the order of [`Law::FILM_PARAMETERS`].
    pub slopes: [f64; 2],
}

/// Input of one integration step of a film along a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmStep {
    /// Absolute surface speeds |U| at the start, middle and end of the step, m/s.
    pub speed_m_s: [f64; 3],
    /// Length of the step, s.
    pub dt_s: f64,
    /// Load on the bearing, N.
    pub load_n: f64,
}

/// Law without film and friction that passes the integration steps of a record to `sink`.
#[derive(Clone, Copy, Debug)]
pub struct FilmSteps<F> {
    sink: F,
}

impl<F> FilmSteps<F> {
    /// Creates a law that passes each integration step to `sink`.
    pub fn new(sink: F) -> Self {
        Self { sink }
    }
}

impl<F: Fn(FilmStep)> Law<f64> for FilmSteps<F> {
    /// Load on the bearing, N.
    type State = f64;

    fn start(&self, load_n: f64) -> f64 {
        load_n
    }
    fn longest_step_s(&self, _: f64) -> f64 {
        f64::INFINITY
    }
    fn set_load(&self, state: &mut f64, load_n: f64) {
        *state = load_n;
    }
    fn friction(&self, _: &f64, _: f64) -> Friction<f64> {
        Friction::NONE
    }
    #[inline(always)]
    fn advance(&self, load_n: &mut f64, speed_m_s: [f64; 3], _: f64, dt_s: f64) {
        (self.sink)(FilmStep {
            speed_m_s,
            dt_s,
            load_n: *load_n,
        });
    }
}

/// Law whose film takes its states from a stored path.
///
/// Effects on the drive, the lubricant and the film would change the path and must not be combined
/// with this law.
#[derive(Clone, Copy, Debug)]
pub struct OnPath<'a, T, L> {
    law: L,
    parameters: [T; 2],
    path: &'a [Place],
    /// Index in the path for each step of the chain; `None` if the chain makes every step of the
    /// path.
    ends: Option<&'a [u32]>,
}

impl<'a, T, L> OnPath<'a, T, L> {
    /// Creates a law from its two film parameters, which carry derivatives, and the stored path for
    /// these parameters.
    pub fn new(law: L, parameters: [T; 2], path: &'a [Place]) -> Self {
        Self {
            law,
            parameters,
            path,
            ends: None,
        }
    }

    /// Sets the index in the path of the last step before each sample except the first, for
    /// [`jbf_core::internals::Steps::Last`].
    pub fn at(self, ends: &'a [u32]) -> Self {
        Self {
            ends: Some(ends),
            ..self
        }
    }

    #[inline(always)]
    fn place(&self, step: usize) -> Option<&Place> {
        match self.ends {
            None => self.path.get(step),
            Some(ends) => self.path.get(*ends.get(step)? as usize),
        }
    }
}

impl<T: Real, L: Law<T>> Law<T> for OnPath<'_, T, L> {
    /// State of the law, and the number of steps of the film since the start.
    type State = (L::State, usize);

    const HAS_BRISTLE: bool = L::HAS_BRISTLE;
    const BENDS_WHOLE: bool = L::BENDS_WHOLE;
    const HAS_STATIC_LEVEL: bool = L::HAS_STATIC_LEVEL;

    fn start(&self, load_n: T) -> Self::State {
        (self.law.start(load_n), 0)
    }
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64 {
        self.law.longest_step_s(top_speed_m_s)
    }
    #[inline(always)]
    fn pressed_n(&self, load_n: T) -> T {
        self.law.pressed_n(load_n)
    }
    #[inline(always)]
    fn load_share(&self, load_n: T) -> T {
        self.law.load_share(load_n)
    }
    #[inline(always)]
    fn set_load(&self, state: &mut Self::State, load_n: T) {
        self.law.set_load(&mut state.0, load_n);
    }
    #[inline(always)]
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Friction<T> {
        self.law.friction(&state.0, velocity_m_s)
    }
    #[inline(always)]
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T) {
        let Some(place) = self.place(state.1) else {
            // Beyond the end of the path the film is integrated.
            return self.law.advance(&mut state.0, speed_m_s, rate, dt_s);
        };
        let [first, second] = self.parameters;
        let [by_first, by_second] = place.slopes;
        let film = T::joined(place.film, [(first, by_first), (second, by_second)]);
        self.law.put_film(&mut state.0, film);
        state.1 += 1;
    }
    #[inline(always)]
    fn bend(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        self.law.bend(&mut state.0, from, to, level, dt_s)
    }
}
