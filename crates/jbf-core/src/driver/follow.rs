//! The driver itself: from kink to kink in steps that the error allows.

use super::goal::{inverse_root, Goal};
use super::kinks::{eps_along, polynomial, root};
use super::{checked, Cost, Excitation, Film, Sample, Start};
use crate::error::Error;
use crate::law::journal::Loaded;
use crate::real::Real;
use crate::stepper::rodas5p::{self, Input};
use crate::stepper::rodas5p_tableau::NODES;
use crate::stepper::{Linear, StiffSystem};

/// Follow `film` along `excitation` from `start`, and hand the film at each of `times_s`
/// (rising) to `sink` with its index, the friction coefficient right to about `tolerance`.
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
    checked(start, times_s, tolerance)?;
    let journal = film.journal();
    let loaded = journal.nominal();
    let eps = start.eps.unwrap_or(loaded.eps_tr);
    let state = film.at([eps * start.phi_rad.cos(), eps * start.phi_rad.sin()]);
    let mut way = Way {
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
    way.step_s = crate::law::Law::longest_step_s(journal, top) * libm::sqrt(libm::sqrt(tolerance));
    way.emit_start();
    while way.next < times_s.len() {
        way.stretch();
    }
    Ok(way.cost)
}

/// What a step does at eps_tr.
enum Touch {
    /// It stays on its side.
    No,
    /// It passes at this share of its length.
    At(f64),
    /// It began on the other side already: the side was mistaken.
    Wrong,
}

/// Eccentricity ratio of a state.
fn radius<T: Real, const N: usize>(state: &[T; N]) -> f64 {
    libm::sqrt((state[0] * state[0] + state[1] * state[1]).value())
}

struct Way<'a, T, F, E, S, const N: usize> {
    film: &'a F,
    excitation: &'a E,
    loaded: Loaded<T>,
    times_s: &'a [f64],
    sink: S,
    time_s: f64,
    state: [T; N],
    touching: bool,
    /// What the error control proposes for the next step, s.
    step_s: f64,
    next: usize,
    goal: Goal,
    cost: Cost,
}

impl<T, F, E, S, const N: usize> Way<'_, T, F, E, S, N>
where
    T: Real,
    F: Film<T, N>,
    E: Excitation,
    S: FnMut(usize, &Sample<T>),
{
    /// From here to the next kink of the excitation or the last sample.
    fn stretch(&mut self) {
        let last = self.times_s[self.times_s.len() - 1];
        let mut end = self.excitation.next_kink_s(self.time_s).min(last);
        let direction = self.direction(end);
        let journal = self.film.journal();
        let clock = journal.rate.value();
        let u = journal.inverse_u_tr;
        let excitation = self.excitation;
        let input = |speed: f64| T::of(direction * speed) * u;
        let rate = |t: f64| {
            T::of(direction * excitation.acceleration_m_s2(t)) * u * (T::ONE / journal.rate)
        };
        let mut system = self.film.system(self.touching);
        let mut speed_here = excitation.velocity_m_s(self.time_s);
        let mut linear = self.linearise(&system, input(speed_here));
        let mut rate_here = rate(self.time_s);
        let mut stale = false;
        let mut landing_on_touch = None;
        let mut turned = false;
        while self.time_s < end {
            if core::mem::take(&mut stale) {
                linear = self.linearise(&system, input(speed_here));
                rate_here = rate(self.time_s);
            }
            let room = end - self.time_s;
            let wanted = landing_on_touch.unwrap_or(self.step_s);
            let step_s = if wanted >= 0.999 * room {
                room
            } else if wanted > 0.5 * room && landing_on_touch.is_none() {
                0.5 * room
            } else {
                wanted
            };
            let to = if step_s == room {
                end
            } else {
                self.time_s + step_s
            };
            let dt = T::of(step_s) * journal.rate;
            let at = |c: f64| input(excitation.velocity_m_s(self.time_s + c * step_s));
            let speed_there = excitation.velocity_m_s(to);
            let seen = Input {
                at_nodes: NODES.map(at),
                at_end: input(speed_there),
                change: rate_here * dt,
            };
            let stages = rodas5p::step(&system, &linear, &self.state, &seen, dt);
            self.cost.slopes += 7;
            let (eps_here, eps) = (radius(&self.state), radius(&stages.end));
            let depth = eps - self.loaded.eps_tr.value();
            let error = stages.error();
            let share = self
                .goal
                .share([error[0].value(), error[1].value()], depth, eps);
            let shortest = 1e-14 / clock + 4e-16 * libm::fabs(self.time_s);
            // No step takes more than three quarters of the gap: asperities told to be free hold
            // nothing back.
            let sound = share.is_finite() && 1.0 - eps > 0.25 * (1.0 - eps_here);
            if !(share <= 1.0 && sound) && step_s > shortest {
                self.cost.rejected += 1;
                let factor = if sound {
                    (0.9 * inverse_root(share)).clamp(0.1, 0.9)
                } else {
                    0.1
                };
                self.step_s = (step_s * factor).max(shortest);
                landing_on_touch = None;
                continue;
            }
            if step_s <= shortest {
                self.cost.forced += 1;
                if !sound {
                    // Nothing left to try: the film waits where it is.
                    let [x, y] = [self.state[0], self.state[1]];
                    self.state = self.film.at([x, y]);
                    let nil = T::ZERO;
                    self.emit(
                        &[[x, nil, nil, nil, nil], [y, nil, nil, nil, nil]],
                        step_s,
                        to,
                    );
                    (self.time_s, speed_here) = (to, speed_there);
                    self.step_s = 1e4 * shortest;
                    (stale, landing_on_touch) = (true, None);
                    continue;
                }
            }
            if let Some(zero) = self.untold_reversal(to, speed_there, direction) {
                end = zero;
                self.cost.rejected += 1;
                continue;
            }
            let from = core::mem::replace(&mut self.state, stages.end);
            let along = [stages.quartic(&from, 0), stages.quartic(&from, 1)];
            match self.passes_touch(&along) {
                Touch::Wrong if !turned => {
                    self.state = from;
                    self.cost.rejected += 1;
                    self.touching = !self.touching;
                    system = self.film.system(self.touching);
                    stale = true;
                    landing_on_touch = None;
                    turned = true;
                    continue;
                }
                Touch::At(share) if landing_on_touch.is_none() && share * step_s > shortest => {
                    self.state = from;
                    self.cost.rejected += 1;
                    landing_on_touch = Some(share * step_s);
                    continue;
                }
                _ => turned = false,
            }
            self.emit(&along, step_s, to);
            self.cost.steps += 1;
            (self.time_s, speed_here) = (to, speed_there);
            stale = true;
            if landing_on_touch.take().is_some() {
                self.touching = !self.touching;
                system = self.film.system(self.touching);
            } else {
                let factor = (0.8 * inverse_root(share.max(1e-8))).min(5.0);
                if step_s == self.step_s || factor < 1.0 || step_s * factor > self.step_s {
                    self.step_s = step_s * factor;
                }
            }
        }
        self.time_s = end;
    }

    fn linearise(&mut self, system: &F::System, ub: T) -> Linear<T, N> {
        self.cost.linearisations += 1;
        system.linearise(&self.state, ub)
    }

    /// Sign of the speed on the stretch that ends at `end`.
    fn direction(&self, end: f64) -> f64 {
        let ahead = (0.01 * self.step_s).min(0.5 * (end - self.time_s));
        self.excitation.velocity_m_s(self.time_s + ahead).sign()
    }

    /// Where between here and `to` the speed leaves `direction`, if it does.
    #[inline]
    fn untold_reversal(&self, to: f64, at_end: f64, direction: f64) -> Option<f64> {
        if at_end * direction > 0.0 || at_end == direction {
            return None;
        }
        self.reversal_before(to, at_end)
    }

    #[cold]
    fn reversal_before(&self, to: f64, at_end: f64) -> Option<f64> {
        let speed = |t: f64| self.excitation.velocity_m_s(t);
        // A kink that was told: landed on, but for rounding.
        let ahead = 1e-3 * (to - self.time_s);
        if libm::fabs(at_end) <= 1e-9 * libm::fabs(speed(to - ahead) - at_end) / 1e-3 {
            return None;
        }
        let zero = root(self.time_s + ahead, to, 1e-15 * libm::fabs(to), speed);
        (zero > self.time_s + ahead).then_some(zero)
    }

    /// Do asperities that part, or a free film, approach each other here?
    fn closes_in(&mut self) -> bool {
        let ub = T::of(libm::fabs(self.excitation.velocity_m_s(self.time_s)));
        let ub = ub * self.film.journal().inverse_u_tr;
        let system = self.film.system(false);
        let slope = self.linearise(&system, ub).slope;
        (self.state[0] * slope[0] + self.state[1] * slope[1]).value() > 0.0
    }

    /// Does the eccentricity leave its side of eps_tr along a step?
    fn passes_touch(&self, along: &[[T; 5]; 2]) -> Touch {
        let side = if self.touching { 1.0 } else { -1.0 };
        let eps_tr = self.loaded.eps_tr.value();
        let inside = |s: f64| side * (eps_along(along, s) - eps_tr);
        let Some(beyond) = [1.0, 0.5]
            .into_iter()
            .find(|&s| inside(s) < -self.goal.band)
        else {
            return Touch::No;
        };
        if inside(0.0) <= 0.0 {
            return Touch::Wrong;
        }
        Touch::At(root(0.0, beyond, 1e-6, inside))
    }

    fn emit_start(&mut self) {
        while self.times_s.get(self.next) == Some(&self.time_s) {
            self.hand_over([self.state[0], self.state[1]], self.time_s);
        }
    }

    /// Hand over the samples of a step.
    fn emit(&mut self, along: &[[T; 5]; 2], step_s: f64, to: f64) {
        let (from, inverse) = (self.time_s, 1.0 / step_s);
        while let Some(&t) = self.times_s.get(self.next) {
            if t > to {
                break;
            }
            let s = T::of((t - from) * inverse);
            self.hand_over([polynomial(&along[0], s), polynomial(&along[1], s)], t);
        }
    }

    #[inline]
    fn hand_over(&mut self, xy: [T; 2], time_s: f64) {
        let e2 = xy[0] * xy[0] + xy[1] * xy[1];
        let velocity_m_s = self.excitation.velocity_m_s(time_s);
        let journal = self.film.journal();
        let sliding = journal.sliding(&self.loaded, e2, T::of(velocity_m_s));
        let sample = Sample {
            xy,
            eps: e2.sqrt(),
            coefficient: sliding.coefficient(T::of(velocity_m_s.sign())),
        };
        (self.sink)(self.next, &sample);
        self.next += 1;
    }
}
