//! Learning friction compensator of Cohn (1998) for a journal bearing.
//!
//! A film model in the control loop predicts the friction. An integral rule adapts two parameters
//! of the film to the control error: K0 in mixed lubrication and gamma in full film.
//!
//!
//! ```text
//! velocity   p -= C e sgn(v)                                     (6.4), (6.5)
//! position   p += C min(|e|, clip) (+1 towards the goal or at rest, -1 away from it)
//!            not at all for |e| > gate                           Figure 6.1, Appendix E
//! ```
//!
//! Here p = K0 where eps > eps_tr, otherwise gamma. In velocity control the friction has the sign
//! of the speed. In position control Appendix E gives it the sign that drives towards the goal.
//!
//! Source: Cohn (1998), sections 6.4 and 6.5, Figure 6.1, Appendices D and E.

mod rule;
mod settings;

pub use rule::Rule;
pub use settings::Settings;

use super::{Compensator, Input, Output};
use crate::error::Error;
use crate::law::journal::{Journal, State as Film};
use crate::law::Law;
use crate::real::Real;
use crate::stepper::Euler;

/// The two learned parameters of the film, which are worth storing while the power is off.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learned<T> {
    /// Asperity stiffness constant.
    pub k0: T,
    /// Slope factor of the viscous term.
    pub gamma: T,
}

impl Learned<f64> {
    /// Initial values in the programs of Cohn (1998).
    pub const THESIS: Self = Self {
        k0: 650_000.0,
        gamma: 33.0,
    };
}

/// Learning friction compensator of Cohn (1998) for a journal bearing.
///
/// For any other law, [`Observed`](super::Observed) learns the friction level.
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

/// State of the film, and the learned parameters.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    film: Film<T>,
    /// Learned parameters of the film.
    pub learned: Learned<T>,
}

impl<T: Real> Learning<T> {
    /// Creates a compensator from a film, whose K0 is the initial value, and settings.
    ///
    /// # Errors
    /// Reports the name of the setting that violates its rule. The bounds must enclose the initial
    /// values.
    pub fn new(law: Journal<T>, s: &Settings) -> Result<Self, Error> {
        s.check(law.k0.value())?;
        let cast = |l: Learned<f64>| Learned {
            k0: T::of(l.k0),
            gamma: T::of(l.gamma),
        };
        Ok(Self {
            law,
            rule: s.rule.cast(),
            gain: cast(s.gain),
            begin: Learned {
                k0: law.k0,
                gamma: T::of(s.gamma),
            },
            least: cast(s.least),
            most: cast(s.most),
            inverse_gamma: T::of(1.0 / s.gamma),
            radius_m: T::of(s.radius_m),
            volts: T::of(s.volts),
            dt_s: T::of(s.dt_s),
        })
    }

    /// Starts from the parameters that an earlier run learned, limited to their bounds.
    ///
    /// If any parameter is not finite, nothing changes.
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
    fn step(&self, state: &mut State<T>, input: &Input<T>) -> Output<T> {
        let v = input.velocity_rad_s;
        let speed_m_s = v.abs() * self.radius_m;
        let mut law = self.law;
        law.k0 = state.learned.k0;
        let sliding = law.friction(&state.film, speed_m_s);
        let viscous = sliding.smooth * (state.learned.gamma * self.inverse_gamma);
        let size_v = (sliding.jump + viscous) * self.volts;
        let sum_v = size_v * self.rule.direction(input);
        let learned = state.learned;
        if input.may_learn {
            let lesson = self.rule.lesson(input);
            let mut next = learned;
            if state.film.eps() > state.film.loaded.eps_tr {
                next.k0 += self.gain.k0 * lesson;
            } else {
                next.gamma += self.gain.gamma * lesson;
            }
            state.learned = self.held(next);
        }
        law.advance_with(&Euler, &mut state.film, [speed_m_s; 3], T::ONE, self.dt_s);
        Output {
            sum_v,
            friction_v: size_v * v.sign(),
            correction_v: T::ZERO,
            forward_v: T::ZERO,
            learned: [learned.k0, learned.gamma],
        }
    }
}
