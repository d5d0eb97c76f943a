//! Description of an effect: the single source for the command line, the documentation, and the
//! bounds and start values of the fit.

use super::need::Need;
use crate::error::ParameterError;
use crate::law;
use crate::page::{in_bounds, Parameter};
use crate::real::Real;
use core::fmt;

/// Position of an effect in the signal chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Between encoder and journal.
    Drive,
    /// Properties of the oil.
    Lubricant,
    /// Dynamics of the film.
    Film,
    /// Between the surfaces.
    Contact,
    /// Friction in addition to that of the bearing.
    Other,
    /// Between the force and the record.
    Instrument,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stage::Drive => "drive",
            Stage::Lubricant => "lubricant",
            Stage::Film => "film",
            Stage::Contact => "contact",
            Stage::Other => "other friction",
            Stage::Instrument => "instrument",
        })
    }
}

/// Description of one effect.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Fixed name.
    pub name: &'static str,
    /// Stage of the signal chain.
    pub stage: Stage,
    /// Physical meaning in a machine, in one line.
    pub summary: &'static str,
    /// Equation, in plain characters.
    pub equation: &'static str,
    /// Source of the equation.
    pub source: &'static str,
    /// Limits of validity of the equation.
    pub limits: &'static str,
    /// Parameters, in order.
    pub parameters: &'static [Parameter],
    /// Requirements on the law and the record without which the effect has no meaning.
    pub needs: &'static [Need],
    /// Longest inner step, s, at which the error of the effect is at most a hundredth of a usual
    /// noise.
    pub longest_step_s: f64,
    /// True for a force other than friction that the drive's transmission carries: a weight, a
    /// mass.
    pub transmitted: bool,
    /// Name of the effect that this effect repeats; without that effect, this one is equal to it.
    pub further_of: Option<&'static str>,
    /// True if the first sample of a run does not determine the initial state and the state does
    /// not decay with time.
    ///
    /// Only a reversal of its input erases such a state.
    pub unknown_start: bool,
}

impl Info {
    /// Creates an empty description: no parameters, no requirements, steps of 20 ms.
    pub const fn new(name: &'static str, stage: Stage) -> Self {
        Self {
            name,
            stage,
            summary: "",
            equation: "",
            source: "",
            limits: "",
            parameters: &[],
            needs: &[],
            longest_step_s: 0.02,
            transmitted: false,
            further_of: None,
            unknown_start: false,
        }
    }

    /// Sets the physical meaning in a machine, in one line.
    pub const fn summary(mut self, text: &'static str) -> Self {
        self.summary = text;
        self
    }

    /// Sets the equation, in plain characters.
    pub const fn equation(mut self, text: &'static str) -> Self {
        self.equation = text;
        self
    }

    /// Sets the source of the equation.
    pub const fn source(mut self, text: &'static str) -> Self {
        self.source = text;
        self
    }

    /// Sets the limits of validity of the equation.
    pub const fn limits(mut self, text: &'static str) -> Self {
        self.limits = text;
        self
    }

    /// Sets the parameters, in order.
    pub const fn parameters(mut self, pages: &'static [Parameter]) -> Self {
        self.parameters = pages;
        self
    }

    /// Sets the requirements on the law and the record.
    pub const fn needs(mut self, needs: &'static [Need]) -> Self {
        self.needs = needs;
        self
    }

    /// Sets the longest inner step that is still exact, s.
    pub const fn longest_step_s(mut self, step_s: f64) -> Self {
        self.longest_step_s = step_s;
        self
    }

    /// Marks a force that the drive's transmission carries.
    pub const fn transmitted(mut self) -> Self {
        self.transmitted = true;
        self
    }

    /// Marks the effect as a repetition of the effect of that name.
    pub const fn further(mut self, of: &'static str) -> Self {
        self.further_of = Some(of);
        self
    }

    /// Marks an initial state that the first sample does not determine and that persists.
    pub const fn unknown_start(mut self) -> Self {
        self.unknown_start = true;
        self
    }

    /// Checks a list of values against the bounds.
    ///
    /// A null value is always allowed, even where it is infinite.
    ///
    /// # Errors
    /// Names the first value that is missing or out of bounds.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), ParameterError> {
        in_bounds(self.parameters, values)
    }

    /// First requirement that a law does not meet, if any; the effect then does not apply.
    pub fn lacking(&self, law: &law::Info) -> Option<Need> {
        self.needs.iter().copied().find(|need| !need.met_by(law))
    }

    /// True if the value of a parameter is its infinite null.
    ///
    /// The effect is then omitted, which is the only exact form of this limit.
    pub fn absent<T: Real>(&self, values: &[T]) -> bool {
        self.parameters.iter().zip(values).any(|(p, v)| {
            p.null
                .is_some_and(|null| !null.is_finite() && v.value() == null)
        })
    }
}
