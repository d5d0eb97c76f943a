//! Integration of a film along an excitation, from kink to kink, with output at the samples.

use super::goal::Goal;
use super::kinks::polynomial;
use super::{checked, Cost, Excitation, Film, Sample, Start};
use crate::error::Error;
use crate::law::journal::{square, Loaded};
use crate::real::Real;
use crate::root::sqrt;
use crate::stepper::{Linear, StiffSystem};
use nalgebra::{SVector, Vector2};

/// Integrates `film` along `excitation` from `start`, with output at each of `times_s` (ascending).
///
/// The receiver `sink` is called with each sample and its index. The error of the friction
/// coefficient is about `tolerance`.
///
/// # Errors
/// As [`super::trajectory`].
pub fn follow<T: Real, F: Film<T, N>, E: Excitation, const N: usize>(
    film: &F,
    excitation: &E,
    start: &Start<T>,
    times_s: &[f64],
    tolerance: f64,
    sink: impl FnMut(usize, &Sample<T>),
) -> Result<Cost, Error> {
    let mut way = Way::from_start(film, excitation, start, times_s, tolerance, sink)?;
    while !way.done() {
        way.stretch();
    }
    Ok(way.cost)
}

/// Eccentricity ratio of the journal in a state of the integration.
pub(super) fn radius<T: Real, const N: usize>(state: &SVector<T, N>) -> f64 {
    sqrt((state[0] * state[0] + state[1] * state[1]).value())
}

/// Integration of a film along an excitation, in progress.
pub(super) struct Way<'a, T, F, E, S, const N: usize> {
    pub(super) film: &'a F,
    pub(super) excitation: &'a E,
    pub(super) loaded: Loaded<T>,
    pub(super) times_s: &'a [f64],
    sink: S,
    pub(super) time_s: f64,
    pub(super) state: SVector<T, N>,
    pub(super) touching: bool,
    /// Length of the next step, proposed by the error control, s.
    pub(super) step_s: f64,
    next: usize,
    pub(super) goal: Goal,
    pub(super) cost: Cost,
}

impl<'a, T, F, E, S, const N: usize> Way<'a, T, F, E, S, N>
where
    T: Real,
    F: Film<T, N>,
    E: Excitation,
    S: FnMut(usize, &Sample<T>),
{
    /// Creates the integration at its start, and outputs the samples at this time.
    pub(super) fn from_start(
        film: &'a F,
        excitation: &'a E,
        start: &Start<T>,
        times_s: &'a [f64],
        tolerance: f64,
        sink: S,
    ) -> Result<Self, Error> {
        checked(start, times_s, tolerance)?;
        let journal = film.journal();
        let loaded = journal.nominal();
        let eps = start.eps.unwrap_or(loaded.eps_tr);
        let state = film.at(Vector2::new(start.phi_rad.cos(), start.phi_rad.sin()) * eps);
        let mut way = Self {
            film,
            excitation,
            loaded,
            times_s,
            sink,
            time_s: start.time_s,
            state,
            touching: eps.value() > loaded.eps_tr.value(),
            step_s: 0.0,
            next: 0,
            goal: Goal::new(film, &loaded, tolerance.min(0.1)),
            cost: Cost::default(),
        };
        if start.eps.is_none() {
            way.touching = way.closes_in();
        }
        let top = libm::fabs(excitation.velocity_m_s(start.time_s));
        way.step_s = crate::law::Law::longest_step_s(journal, top) * sqrt(sqrt(tolerance));
        way.emit_start();
        Ok(way)
    }

    /// Returns true if all samples have been output.
    #[inline]
    pub(super) fn done(&self) -> bool {
        self.next >= self.times_s.len()
    }

    pub(super) fn linearise(&mut self, system: &F::System, ub: T) -> Linear<T, N> {
        self.cost.linearisations += 1;
        system.linearise(&self.state, ub)
    }

    /// Returns true if the eccentricity increases at the present state according to the equations
    /// without asperity contact.
    fn closes_in(&mut self) -> bool {
        let ub = T::of(libm::fabs(self.excitation.velocity_m_s(self.time_s)));
        let ub = ub * self.film.journal().inverse_u_tr;
        let system = self.film.system(false);
        let slope = self.linearise(&system, ub).slope;
        (self.state[0] * slope[0] + self.state[1] * slope[1]).value() > 0.0
    }

    fn emit_start(&mut self) {
        while self.times_s.get(self.next) == Some(&self.time_s) {
            self.hand_over(Vector2::new(self.state[0], self.state[1]), self.time_s);
        }
    }

    /// Outputs the samples inside a step from polynomials of the position along the step.
    pub(super) fn emit(&mut self, along: &[[T; 5]; 2], step_s: f64, to: f64) {
        let (from, inverse) = (self.time_s, 1.0 / step_s);
        while let Some(&t) = self.times_s.get(self.next) {
            if t > to {
                break;
            }
            let s = T::of((t - from) * inverse);
            let xy = Vector2::new(polynomial(&along[0], s), polynomial(&along[1], s));
            self.hand_over(xy, t);
        }
    }

    #[inline]
    fn hand_over(&mut self, xy: Vector2<T>, time_s: f64) {
        let e2 = square(&xy);
        let velocity_m_s = self.excitation.velocity_m_s(time_s);
        let journal = self.film.journal();
        let sliding = journal.sliding(&self.loaded, e2, T::of(velocity_m_s));
        let sample = Sample {
            xy,
            eps: e2.sqrt(),
            coefficient: sliding.along(T::of(velocity_m_s.sign())),
        };
        (self.sink)(self.next, &sample);
        self.next += 1;
    }
}
