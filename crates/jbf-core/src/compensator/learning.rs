//! The thesis's learning compensator: the film model runs in the loop, and a ratchet on the error
//! learns its K0 in mixed lubrication, its gamma in full film.
//!
//! ```text
//! velocity   p -= C e sgn(v)                                     (6.4), (6.5)
//! position   p += C min(|e|, clip) (+1 towards the goal or at rest, -1 away from it)
//!            not at all for |e| > gate                           Figure 6.1, Appendix E
//! ```
//!
//! with p = K0 where eps > eps_tr, else gamma. In velocity control the friction has the sign of
//! the speed; in position control Appendix E gives it the sign that drives towards the goal.
//!
//! Source: Cohn (1998), sections 6.4 and 6.5, Figure 6.1, Appendices D and E.

use super::{Answer, Compensator, Sense};
use crate::error::{check, not_negative, positive, Error};
use crate::law::journal::{Journal, State as Film};
use crate::law::Law;
use crate::real::Real;
use crate::stepper::Euler;

/// What the error means, and so how it teaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule<T> {
    /// Error of speed.
    Velocity,
    /// Error of angle: no learning beyond `gate_rad`, the error clipped to `clip_rad`.
    Position {
        /// 0.8 rad in the thesis.
        gate_rad: T,
        /// 0.3 rad in the thesis.
        clip_rad: T,
    },
}

/// The two learned parameters. They are what is worth keeping over a power cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learned<T> {
    /// Asperity stiffness constant.
    pub k0: T,
    /// Slope factor of the viscous term.
    pub gamma: T,
}

/// The thesis's compensator.
#[derive(Clone, Copy, Debug)]
pub struct Learning<T> {
    law: Journal<T>,
    rule: Rule<T>,
    gain: Learned<T>,
    begin: Learned<T>,
    least: Learned<T>,
    most: Learned<T>,
    inverse_gamma: T,
    radius_m: T,
    volts: T,
    dt_s: T,
}

/// Film and learned parameters now.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    film: Film<T>,
    /// What has been learned.
    pub learned: Learned<T>,
}

impl<T: Real> Learning<T> {
    /// A film (its K0 is the one that is learned from), the gamma that it was built with, what a
    /// coefficient of 1 is in volts (25.5 V by the thesis's listings), the journal's radius (m), the learning
    /// gains per step, and the bounds of what may be learned.
    ///
    /// # Errors
    /// Sizes must be positive, gains not negative, the bounds hold the start between them.
    #[allow(clippy::too_many_arguments)]
    pub fn new(
        law: Journal<T>,
        gamma: f64,
        rule: Rule<T>,
        gain: Learned<f64>,
        bounds: [Learned<f64>; 2],
        volts: f64,
        radius_m: f64,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("gamma", gamma)?;
        positive("volts", volts)?;
        positive("radius_m", radius_m)?;
        positive("dt_s", dt_s)?;
        for (name, g) in [("gain.k0", gain.k0), ("gain.gamma", gain.gamma)] {
            not_negative(name, g)?;
        }
        let k0 = law.k0.value();
        let [least, most] = bounds;
        for (name, value, low, high) in [
            ("k0", k0, least.k0, most.k0),
            ("gamma", gamma, least.gamma, most.gamma),
        ] {
            check(
                low > 0.0 && low <= value && value <= high && high.is_finite(),
                name,
                value,
                "must lie within the bounds of learning, which are positive and finite",
            )?;
        }
        let lift = |l: Learned<f64>| Learned {
            k0: T::of(l.k0),
            gamma: T::of(l.gamma),
        };
        Ok(Self {
            law,
            rule,
            gain: lift(gain),
            begin: Learned {
                k0: law.k0,
                gamma: T::of(gamma),
            },
            least: lift(least),
            most: lift(most),
            inverse_gamma: T::of(1.0 / gamma),
            radius_m: T::of(radius_m),
            volts: T::of(volts),
            dt_s: T::of(dt_s),
        })
    }

    /// Begin from what an earlier run learned, held within the bounds; numbers that are none
    /// change nothing.
    #[must_use]
    pub fn resumed(mut self, learned: Learned<T>) -> Self {
        if learned.k0.is_finite() && learned.gamma.is_finite() {
            self.begin = self.held(learned);
        }
        self
    }

    #[inline]
    fn held(&self, l: Learned<T>) -> Learned<T> {
        Learned {
            k0: l.k0.max(self.least.k0).min(self.most.k0),
            gamma: l.gamma.max(self.least.gamma).min(self.most.gamma),
        }
    }

    /// Which way, and how far, the error pushes a parameter: the thesis's `-e sgn(v)`.
    #[inline]
    fn lesson(&self, sense: &Sense<T>) -> T {
        let (v, e) = (sense.velocity_rad_s, sense.error);
        match self.rule {
            Rule::Velocity => -e * v.sign(),
            Rule::Position { gate_rad, clip_rad } => {
                let size = e.abs();
                if size >= gate_rad {
                    T::ZERO
                } else if v * e > T::ZERO {
                    -size.min(clip_rad)
                } else {
                    size.min(clip_rad)
                }
            }
        }
    }

    /// Sign of the friction in the sum.
    #[inline]
    fn direction(&self, sense: &Sense<T>) -> T {
        match self.rule {
            Rule::Velocity => sense.velocity_rad_s.sign(),
            Rule::Position { .. } if sense.error > T::ZERO => -T::ONE,
            Rule::Position { .. } => T::ONE,
        }
    }
}

impl<T: Real> Compensator<T> for Learning<T> {
    type State = State<T>;

    fn start(&self) -> State<T> {
        State {
            // The programs start at eps_tr with phi = 0.
            film: Film::at(self.law.nominal().eps_tr, T::ZERO, self.law.nominal()),
            learned: self.begin,
        }
    }

    #[inline]
    fn step(&self, state: &mut State<T>, sense: &Sense<T>) -> Answer<T> {
        let v = sense.velocity_rad_s;
        let speed_m_s = v.abs() * self.radius_m;
        let mut law = self.law;
        law.k0 = state.learned.k0;
        let sliding = law.friction(&state.film, speed_m_s);
        let viscous = sliding.viscous * (state.learned.gamma * self.inverse_gamma);
        let size_v = (sliding.level + viscous) * self.volts;
        let sum_v = size_v * self.direction(sense);
        let learned = state.learned;
        if sense.may_learn {
            let lesson = self.lesson(sense);
            let mut next = learned;
            if state.film.eps() > state.film.eps_tr() {
                next.k0 += self.gain.k0 * lesson;
            } else {
                next.gamma += self.gain.gamma * lesson;
            }
            state.learned = self.held(next);
        }
        law.advance_with(&Euler, &mut state.film, [speed_m_s; 3], T::ONE, self.dt_s);
        Answer {
            sum_v,
            friction_v: size_v * v.sign(),
            correction_v: T::ZERO,
            forward_v: T::ZERO,
            learned: [learned.k0, learned.gamma],
        }
    }
}
