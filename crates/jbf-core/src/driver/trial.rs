//! Computation and assessment of one trial step of a segment; only the cost counters of the
//! integration change.

use super::follow::{radius, Way};
use super::goal::inverse_root;
use super::kinks::{eps_along, root};
use super::stretch::{Aim, Stretch};
use super::{Excitation, Film, Sample};
use crate::real::Real;
use crate::stepper::rodas5p::{self, Input, Stages};
use crate::stepper::rodas5p_tableau::NODES;
use crate::stepper::{Linear, StiffSystem};
use nalgebra::SVector;

/// Trial step to be computed: equations, state, inputs of its stages, and its end.
#[derive(Clone, Copy, Debug)]
pub struct Asked<T, Y, const N: usize> {
    pub(super) system: Y,
    pub(super) linear: Linear<T, N>,
    pub(super) state: SVector<T, N>,
    pub(super) input: Input<T>,
    /// Length of the step in dimensionless time.
    pub(super) dt: T,
    pub(super) step_s: f64,
    pub(super) to_s: f64,
    pub(super) speed_m_s: f64,
}

impl<T: Real, Y: StiffSystem<T, N>, const N: usize> Asked<T, Y, N> {
    /// Computes the stages of the implicit method for the step.
    #[inline]
    pub(super) fn stages(&self) -> Stages<T, N> {
        rodas5p::step(
            &self.system,
            &self.linear,
            &self.state,
            &self.input,
            self.dt,
        )
    }
}

/// Trial step with its error estimate.
pub(super) struct Tried<'a, T, const N: usize> {
    pub(super) step_s: f64,
    /// Time at the end of the step, s; `speed_m_s` is the surface speed at this time.
    pub(super) to_s: f64,
    pub(super) speed_m_s: f64,
    pub(super) stages: &'a Stages<T, N>,
    /// Estimated error divided by the allowed error.
    pub(super) share: f64,
    /// True if the result is finite and at least a quarter of the gap remains.
    pub(super) sound: bool,
    /// Shortest step that floating-point time resolves at this time, s.
    pub(super) shortest_s: f64,
}

/// Assessment of a trial step.
pub(super) enum Verdict<T> {
    /// The error is too large; the step must be shortened by this factor.
    TooLong(f64),
    /// The step is at the resolution of time, but is not finite or leaves the bearing.
    Stuck,
    /// The surface speed changes sign at this time inside the step, s.
    Reverses(f64),
    /// Asperity contact begins or ends inside the step, this time after its start, s.
    Touches(f64),
    /// The step began on the other side of eps_tr than assumed.
    WrongSide,
    /// The step is accepted; the polynomials are the dense output of the two coordinates of the
    /// journal position.
    Sound([[T; 5]; 2]),
}

/// Position of the journal in a step relative to eps_tr, where asperity contact begins or ends.
enum Touch {
    /// The eccentricity ratio stays on one side of eps_tr.
    No,
    /// The eccentricity ratio passes eps_tr at this fraction of the step.
    At(f64),
    /// The step began on the other side of eps_tr than assumed.
    Wrong,
}

impl<T, F, E, S, const N: usize> Way<'_, T, F, E, S, N>
where
    T: Real,
    F: Film<T, N>,
    E: Excitation,
    S: FnMut(usize, &Sample<T>),
{
    /// Length of the next trial step, s; the remainder of the segment is never too short for a
    /// step.
    #[inline]
    fn length(&self, stretch: &Stretch<T, F::System, N>) -> f64 {
        let room = stretch.end_s - self.time_s;
        let (wanted, landing) = match stretch.aim {
            Aim::Touch(ahead_s) => (ahead_s, true),
            Aim::Ahead | Aim::Turned => (self.step_s, false),
        };
        if wanted >= 0.999 * room {
            room
        } else if wanted > 0.5 * room && !landing {
            0.5 * room
        } else {
            wanted
        }
    }

    /// Prepares the next trial step.
    #[inline]
    pub(super) fn ask(&self, stretch: &Stretch<T, F::System, N>) -> Asked<T, F::System, N> {
        let step_s = self.length(stretch);
        let to_s = if step_s == stretch.end_s - self.time_s {
            stretch.end_s
        } else {
            self.time_s + step_s
        };
        let dt = T::of(step_s) * self.film.journal().rate;
        let seen = |speed_m_s: f64| self.input(stretch.direction * speed_m_s);
        let speed_at = |c: f64| self.excitation.velocity_m_s(self.time_s + c * step_s);
        let speed_m_s = self.excitation.velocity_m_s(to_s);
        let input = Input {
            at_nodes: NODES.map(|c| seen(speed_at(c))),
            at_end: seen(speed_m_s),
            change: stretch.here.rate * dt,
        };
        Asked {
            system: stretch.system,
            linear: stretch.here.linear,
            state: self.state,
            input,
            dt,
            step_s,
            to_s,
            speed_m_s,
        }
    }

    /// Estimates the error of a computed trial step.
    #[inline]
    pub(super) fn tried<'s>(
        &mut self,
        asked: &Asked<T, F::System, N>,
        stages: &'s Stages<T, N>,
    ) -> Tried<'s, T, N> {
        let &Asked {
            step_s,
            to_s,
            speed_m_s,
            ..
        } = asked;
        self.cost.slopes += 7;
        let (eps_here, eps) = (radius(&self.state), radius(&stages.end));
        let depth = eps - self.loaded.eps_tr.value();
        let error = stages.error();
        let share = self
            .goal
            .share([error[0].value(), error[1].value()], depth, eps);
        let clock = self.film.journal().rate.value();
        Tried {
            step_s,
            to_s,
            speed_m_s,
            stages,
            share,
            // No step may use more than three quarters of the gap: without the asperity term
            // nothing resists.
            sound: share.is_finite() && 1.0 - eps > 0.25 * (1.0 - eps_here),
            shortest_s: 1e-14 / clock + 4e-16 * libm::fabs(self.time_s),
        }
    }

    #[inline]
    pub(super) fn judge(
        &mut self,
        stretch: &Stretch<T, F::System, N>,
        tried: &Tried<'_, T, N>,
    ) -> Verdict<T> {
        if tried.step_s > tried.shortest_s {
            if !tried.sound {
                return Verdict::TooLong(0.1);
            }
            if tried.share > 1.0 {
                return Verdict::TooLong((0.9 * inverse_root(tried.share)).clamp(0.1, 0.9));
            }
        } else {
            self.cost.forced += 1;
            if !tried.sound {
                return Verdict::Stuck;
            }
        }
        if let Some(zero_s) = self.untold_reversal(stretch.direction, tried) {
            return Verdict::Reverses(zero_s);
        }
        let stages = tried.stages;
        let along = [
            stages.quartic(&self.state, 0),
            stages.quartic(&self.state, 1),
        ];
        match (self.passes_touch(&along), stretch.aim) {
            (Touch::Wrong, Aim::Ahead | Aim::Touch(_)) => Verdict::WrongSide,
            (Touch::At(share), Aim::Ahead | Aim::Turned)
                if share * tried.step_s > tried.shortest_s =>
            {
                Verdict::Touches(share * tried.step_s)
            }
            _ => Verdict::Sound(along),
        }
    }

    /// Time inside a step at which the sign of the speed differs from `direction`, s; `None` if it
    /// does not change.
    #[inline]
    fn untold_reversal(&self, direction: f64, tried: &Tried<'_, T, N>) -> Option<f64> {
        if tried.speed_m_s * direction > 0.0 || tried.speed_m_s == direction {
            return None;
        }
        self.reversal_before(tried.to_s, tried.speed_m_s)
    }

    #[cold]
    fn reversal_before(&self, to_s: f64, at_end: f64) -> Option<f64> {
        let speed = |t: f64| self.excitation.velocity_m_s(t);
        // A reported kink on which the step landed, apart from rounding.
        let ahead = 1e-3 * (to_s - self.time_s);
        if libm::fabs(at_end) <= 1e-9 * libm::fabs(speed(to_s - ahead) - at_end) / 1e-3 {
            return None;
        }
        let zero = root(self.time_s + ahead, to_s, 1e-15 * libm::fabs(to_s), speed);
        (zero > self.time_s + ahead).then_some(zero)
    }

    /// Determines whether the eccentricity ratio passes eps_tr along a step.
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
}

#[cfg(test)]
mod tests {
    use super::super::{Sine, Start};
    use super::*;
    use crate::law::journal::{Journal, Parameters};
    use crate::{Bearing, Clock};
    use nalgebra::Vector2;

    /// A step is accepted only if it uses at most three quarters of the gap to the wall, whatever
    /// its error is.
    ///
    /// A step out of the bearing and a step that is not a number are rejected.
    #[test]
    fn step_is_accepted_only_if_a_quarter_of_the_gap_remains() {
        let law = Journal::new(
            &Bearing::THESIS,
            104.0,
            &Parameters::TABLE_4_2,
            Clock::Journal,
        )
        .expect("valid");
        let motion = Sine::new(0.127, 1.0).expect("valid");
        for eps in [0.2, 0.6, 0.99] {
            let start = Start {
                eps: Some(eps),
                phi_rad: 0.0,
                ..Start::default()
            };
            let mut way = Way::from_start(&law, &motion, &start, &[1.0], 1e-6, |_, _| ())
                .expect("a tolerance");
            let stretch = way.begin();
            let asked = way.ask(&stretch);
            let mut stages = asked.stages();
            let ends = [
                (0.0, true),
                (0.74, true),
                (0.76, false),
                (1.2, false),
                (-0.2, true),
            ];
            for (share, sound) in ends {
                stages.end = Vector2::new(eps + share * (1.0 - eps), 0.0);
                assert_eq!(way.tried(&asked, &stages).sound, sound, "{eps} {share}");
            }
            stages.end = Vector2::new(f64::NAN, 0.0);
            assert!(!way.tried(&asked, &stages).sound);
        }
    }
}
