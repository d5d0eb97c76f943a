//! The path of a film along a record, kept: a film is told the motion and its own two parameters and
//! nothing of what stands behind it, so that chains that differ only there need not step it again.
//!
//! [`FilmSteps`] is a law that tells which steps a record asks of a film, [`OnPath`] one whose film
//! goes from place to place of a list. On the path of its own parameters it gives the same bits.

use crate::friction::Friction;
use crate::law::Law;
use crate::motion::JournalMotion;
use crate::real::Real;

/// What friction is told of the film at the end of one step ([`Law::film`]), and its derivatives by
/// the law's two film parameters ([`Law::FILM_PARAMETERS`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The film.
    pub film: f64,
    /// Its derivatives, in the order of [`Law::FILM_PARAMETERS`].
    pub slopes: [f64; 2],
}

/// One step that a record asks of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmStep {
    /// |U| at its start, middle and end, m/s.
    pub speed_m_s: [f64; 3],
    /// Its length, s.
    pub dt_s: f64,
    /// Load on the bearing, N.
    pub load_n: f64,
}

/// A law without a film: it hands the steps that one would make to `sink`.
#[derive(Clone, Copy, Debug)]
pub struct FilmSteps<F> {
    sink: F,
}

impl<F> FilmSteps<F> {
    /// Where the steps go.
    pub fn new(sink: F) -> Self {
        Self { sink }
    }
}

impl<F: Fn(FilmStep)> Law<f64> for FilmSteps<F> {
    /// The load, N.
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

/// A law whose film follows a path. Effects before the film, which would change its path, have no
/// place round it.
#[derive(Clone, Copy, Debug)]
pub struct OnPath<'a, T, L> {
    law: L,
    parameters: [T; 2],
    path: &'a [Place],
    /// Of each step that is made its number on the path; all are made where there are none.
    ends: Option<&'a [u32]>,
}

impl<'a, T, L> OnPath<'a, T, L> {
    /// The law, its two film parameters with the derivatives they carry, and their path.
    pub fn new(law: L, parameters: [T; 2], path: &'a [Place]) -> Self {
        Self {
            law,
            parameters,
            path,
            ends: None,
        }
    }

    /// The same for [`crate::run::Steps::Last`]: the number, on the path, of the last step before
    /// each sample but the first.
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
    /// The law's own, and how many steps the film has made.
    type State = (L::State, usize);

    const HAS_BRISTLE: bool = L::HAS_BRISTLE;
    const BENDS_WHOLE: bool = L::BENDS_WHOLE;

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
            // Beyond the end of the path the film steps by itself.
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
