//! The catalogue's page of an effect: the one source for the command line, the docs and
//! the fit's bounds and starting values.

use super::need::Need;
use crate::error::ParameterError;
use crate::law;
use crate::page::{in_bounds, Parameter};
use crate::real::Real;
use core::fmt;

/// Where in the signal chain an effect sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Between encoder and journal.
    Drive,
    /// The oil.
    Lubricant,
    /// The film's own dynamics.
    Film,
    /// Between the surfaces.
    Contact,
    /// Friction beside the bearing's.
    Other,
    /// Between force and record.
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

/// The page of one effect.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Fixed name.
    pub name: &'static str,
    /// Stage of the signal chain.
    pub stage: Stage,
    /// One line: what it is in a machine.
    pub summary: &'static str,
    /// The form, in plain characters.
    pub equation: &'static str,
    /// Where the form comes from.
    pub source: &'static str,
    /// Where the form stops being true.
    pub limits: &'static str,
    /// Parameters in order.
    pub parameters: &'static [Parameter],
    /// What the law and the record must have for the effect to mean something.
    pub needs: &'static [Need],
    /// Longest inner step at which the effect is still exact to a hundredth of a usual noise, s.
    pub longest_step_s: f64,
    /// True of a force, beside friction, that the drive's transmission carries: a weight, a mass.
    pub transmitted: bool,
    /// The effect of which this is a further one: without that beside it, it is that one.
    pub further_of: Option<&'static str>,
    /// True where a run's first sample does not tell the state in which it begins, and no time lets
    /// that be forgotten: only a turn of what acts on it does.
    pub unknown_start: bool,
}

impl Info {
    /// A page to be filled in: no parameters, no needs, steps of 20 ms.
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

    /// What it is in a machine, in one line.
    pub const fn summary(mut self, text: &'static str) -> Self {
        self.summary = text;
        self
    }

    /// The form, in plain characters.
    pub const fn equation(mut self, text: &'static str) -> Self {
        self.equation = text;
        self
    }

    /// Where the form comes from.
    pub const fn source(mut self, text: &'static str) -> Self {
        self.source = text;
        self
    }

    /// Where the form stops being true.
    pub const fn limits(mut self, text: &'static str) -> Self {
        self.limits = text;
        self
    }

    /// Parameters in order.
    pub const fn parameters(mut self, pages: &'static [Parameter]) -> Self {
        self.parameters = pages;
        self
    }

    /// What the law and the record must have.
    pub const fn needs(mut self, needs: &'static [Need]) -> Self {
        self.needs = needs;
        self
    }

    /// Longest inner step that is still exact, s.
    pub const fn longest_step_s(mut self, step_s: f64) -> Self {
        self.longest_step_s = step_s;
        self
    }

    /// A force that the drive's transmission carries.
    pub const fn transmitted(mut self) -> Self {
        self.transmitted = true;
        self
    }

    /// A further one of the effect of that name.
    pub const fn further(mut self, of: &'static str) -> Self {
        self.further_of = Some(of);
        self
    }

    /// A state that the first sample does not tell, and that lasts.
    pub const fn unknown_start(mut self) -> Self {
        self.unknown_start = true;
        self
    }

    /// Check a list of values against the bounds. A null value is always allowed, even
    /// where it is infinite.
    ///
    /// # Errors
    /// Names the first value that is missing or out of bounds.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), ParameterError> {
        in_bounds(self.parameters, values)
    }

    /// The need that a law leaves open, where there is one: the effect then does not apply.
    pub fn lacking(&self, law: &law::Info) -> Option<Need> {
        self.needs.iter().copied().find(|need| !need.met_by(law))
    }

    /// True where a parameter stands at an infinite null: the effect is then left out
    /// altogether, which is the only exact way to take such a limit.
    pub fn absent<T: Real>(&self, values: &[T]) -> bool {
        self.parameters.iter().zip(values).any(|(p, v)| {
            p.null
                .is_some_and(|null| !null.is_finite() && v.value() == null)
        })
    }
}
