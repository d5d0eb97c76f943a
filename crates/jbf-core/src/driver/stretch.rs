//! Integration of a segment, the interval from one kink of the excitation to the next, with error
//! control.
//!
//! A step is computed and assessed (`trial.rs`), then accepted or rejected. The [`Aim`] is the
//! state of a segment between two trials:
//!
//! ```text
//! aim            what the step does                          next aim
//! Ahead, Turned  asperities touch or part inside it          Touch
//! Ahead, Touch   it began on the other side already          Turned, on that side
//! Touch          its error is too large                      Ahead
//! Touch          it is sound and lands on eps_tr             Ahead, on the other side
//! Ahead, Turned  it is sound                                 Ahead
//! ```

use super::follow::Way;
use super::goal::inverse_root;
use super::trial::{Asked, Tried, Verdict};
use super::{Excitation, Film, Sample};
use crate::real::Real;
use crate::stepper::rodas5p::Stages;
use crate::stepper::Linear;
use nalgebra::Vector2;

/// Purpose of the next trial step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    /// Advance by the step size of the error control.
    Ahead,
    /// End the step where the eccentricity ratio reaches eps_tr, after this time, s; asperity
    /// contact begins or ends there.
    Touch(f64),
    /// Advance with the equations of the other side of eps_tr, after a trial that began on the
    /// wrong side.
    ///
    /// If this trial begins on the wrong side again, the journal is at eps_tr and the step is
    /// accepted.
    Turned,
}

/// Equations linearised at the start of a step, with the speed and the rate of change of the input
/// at this time.
pub(super) struct Here<T, const N: usize> {
    /// Absolute surface speed, m/s.
    pub(super) speed_m_s: f64,
    pub(super) linear: Linear<T, N>,
    /// Derivative of the input of the equations with respect to dimensionless time.
    pub(super) rate: T,
}

/// Segment of the integration, in progress.
pub(super) struct Stretch<T, Y, const N: usize> {
    /// Sign of the surface speed in the segment.
    pub(super) direction: f64,
    /// End of the segment, s.
    pub(super) end_s: f64,
    pub(super) system: Y,
    pub(super) aim: Aim,
    pub(super) here: Here<T, N>,
}

impl<T, F, E, S, const N: usize> Way<'_, T, F, E, S, N>
where
    T: Real,
    F: Film<T, N>,
    E: Excitation,
    S: FnMut(usize, &Sample<T>),
{
    /// Integrates to the next kink of the excitation or to the last sample.
    pub(super) fn stretch(&mut self) {
        let mut stretch = self.begin();
        while self.time_s < stretch.end_s {
            let asked = self.ask(&stretch);
            self.answer(&mut stretch, &asked, &asked.stages());
        }
        self.time_s = stretch.end_s;
    }

    /// Accepts or rejects a trial step, and determines the next one.
    #[inline]
    pub(super) fn answer(
        &mut self,
        stretch: &mut Stretch<T, F::System, N>,
        asked: &Asked<T, F::System, N>,
        stages: &Stages<T, N>,
    ) {
        let tried = self.tried(asked, stages);
        match self.judge(stretch, &tried) {
            Verdict::TooLong(share) => {
                self.cost.rejected += 1;
                self.step_s = (tried.step_s * share).max(tried.shortest_s);
                if let Aim::Touch(_) = stretch.aim {
                    stretch.aim = Aim::Ahead;
                }
            }
            Verdict::Stuck => self.wait(stretch, &tried),
            Verdict::Reverses(zero_s) => {
                self.cost.rejected += 1;
                stretch.end_s = zero_s;
            }
            Verdict::Touches(ahead_s) => {
                self.cost.rejected += 1;
                stretch.aim = Aim::Touch(ahead_s);
            }
            Verdict::WrongSide => {
                self.cost.rejected += 1;
                self.change_side(stretch);
                stretch.aim = Aim::Turned;
                self.look(stretch);
            }
            Verdict::Sound(along) => self.take(stretch, &tried, &along),
        }
    }

    pub(super) fn begin(&mut self) -> Stretch<T, F::System, N> {
        let last = self.times_s[self.times_s.len() - 1];
        let end_s = self.excitation.next_kink_s(self.time_s).min(last);
        let direction = self.direction(end_s);
        let system = self.film.system(self.touching);
        let speed_m_s = self.excitation.velocity_m_s(self.time_s);
        let input = self.input(direction * speed_m_s);
        Stretch {
            direction,
            end_s,
            here: Here {
                speed_m_s,
                linear: self.linearise(&system, input),
                rate: self.input_rate(direction),
            },
            system,
            aim: Aim::Ahead,
        }
    }

    /// Sign of the surface speed in the segment that ends at `end_s`.
    fn direction(&self, end_s: f64) -> f64 {
        let ahead = (0.01 * self.step_s).min(0.5 * (end_s - self.time_s));
        self.excitation.velocity_m_s(self.time_s + ahead).sign()
    }

    /// Input of the film equations (dimensionless speed) at an unsigned surface speed, m/s.
    #[inline]
    pub(super) fn input(&self, speed_m_s: f64) -> T {
        T::of(speed_m_s) * self.film.journal().inverse_u_tr
    }

    /// Derivative of the input of the equations with respect to dimensionless time, at the present
    /// time.
    #[inline]
    fn input_rate(&self, direction: f64) -> T {
        let journal = self.film.journal();
        T::of(direction * self.excitation.acceleration_m_s2(self.time_s))
            * journal.inverse_u_tr
            * (T::ONE / journal.rate)
    }

    /// Linearises the equations again after a change of the position or of the side of eps_tr.
    #[inline]
    fn look(&mut self, stretch: &mut Stretch<T, F::System, N>) {
        let input = self.input(stretch.direction * stretch.here.speed_m_s);
        stretch.here.linear = self.linearise(&stretch.system, input);
        stretch.here.rate = self.input_rate(stretch.direction);
    }

    fn change_side(&mut self, stretch: &mut Stretch<T, F::System, N>) {
        self.touching = !self.touching;
        stretch.system = self.film.system(self.touching);
    }

    /// Accepts a trial step. Changes to the other side of eps_tr if the step was to end there.
    #[inline]
    fn take(
        &mut self,
        stretch: &mut Stretch<T, F::System, N>,
        tried: &Tried<'_, T, N>,
        along: &[[T; 5]; 2],
    ) {
        self.state = tried.stages.end;
        self.emit(along, tried.step_s, tried.to_s);
        self.cost.steps += 1;
        if let Aim::Touch(_) = stretch.aim {
            self.change_side(stretch);
        } else {
            let factor = (0.8 * inverse_root(tried.share.max(1e-8))).min(5.0);
            let next_s = tried.step_s * factor;
            if tried.step_s == self.step_s || factor < 1.0 || next_s > self.step_s {
                self.step_s = next_s;
            }
        }
        stretch.aim = Aim::Ahead;
        self.go_on(stretch, tried);
    }

    /// Advances the time and keeps the film at its position, because no step is possible.
    #[cold]
    fn wait(&mut self, stretch: &mut Stretch<T, F::System, N>, tried: &Tried<'_, T, N>) {
        let (x, y) = (self.state[0], self.state[1]);
        self.state = self.film.at(Vector2::new(x, y));
        let still = |place: T| [place, T::ZERO, T::ZERO, T::ZERO, T::ZERO];
        self.emit(&[still(x), still(y)], tried.step_s, tried.to_s);
        self.step_s = 1e4 * tried.shortest_s;
        if let Aim::Touch(_) = stretch.aim {
            stretch.aim = Aim::Ahead;
        }
        self.go_on(stretch, tried);
    }

    /// Sets the time to the end of a step, and linearises the equations again if the segment
    /// continues.
    #[inline]
    fn go_on(&mut self, stretch: &mut Stretch<T, F::System, N>, tried: &Tried<'_, T, N>) {
        self.time_s = tried.to_s;
        stretch.here.speed_m_s = tried.speed_m_s;
        if self.time_s < stretch.end_s {
            self.look(stretch);
        }
    }
}
