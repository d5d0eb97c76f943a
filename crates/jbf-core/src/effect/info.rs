//! Description of an effect: the single source for the command line, the documentation, and the
//! bounds and start values of the fit.

use super::need::Need;
use super::Effect;
use crate::error::Error;
use crate::law;
use crate::parameter::{in_bounds, Parameter};
use crate::real::Real;
use core::fmt;

/// Stage of the signal chain at which an effect acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Motion between encoder and journal.
    Drive,
    /// Viscosity of the oil.
    Lubricant,
    /// Dynamics of the film and their dependence on the load.
    Film,
    /// Friction between the surfaces.
    Contact,
    /// Friction in addition to that of the bearing.
    Other,
    /// Measurement of the force.
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

/// Description of an effect in the catalogue.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Unique name of the effect in files and options.
    pub name: &'static str,
    /// Name of the type in Rust: `effect::NAME::RUST_TYPE`.
    pub rust_type: &'static str,
    /// Stage of the signal chain at which the effect acts.
    pub stage: Stage,
    /// Physical meaning of the effect in a machine, in one line.
    pub summary: &'static str,
    /// Equation of the effect, in plain characters.
    pub equation: &'static str,
    /// Source of the equation.
    pub source: &'static str,
    /// Limits of validity of the equation.
    pub limits: &'static str,
    /// Descriptions of the parameters, in the order of their values.
    pub parameters: &'static [Parameter],
    /// Requirements on the law and the record; the effect has no meaning if one is not met.
    pub needs: &'static [Need],
    /// Longest step, s, with which the error of the effect is at most one per cent of a typical
    /// noise; the value is that of [`Effect::LONGEST_STEP_S`].
    pub longest_step_s: f64,
    /// True if the effect has a state.
    pub has_memory: bool,
    /// True if the effect is a force other than friction that the transmission of the drive
    /// carries, such as a weight.
    pub transmitted: bool,
    /// Name of the effect of which this one is a second instance, such as `cogging` for
    /// `cogging_2`.
    pub further_of: Option<&'static str>,
}

impl Info {
    /// Creates a description of the effect `E` without parameters and requirements.
    pub(crate) const fn new<T: Real, E: Effect<T>>(name: &'static str, stage: Stage) -> Self {
        Self {
            name,
            rust_type: "",
            stage,
            summary: "",
            equation: "",
            source: "",
            limits: "",
            parameters: &[],
            needs: &[],
            longest_step_s: E::LONGEST_STEP_S,
            has_memory: E::HAS_MEMORY,
            transmitted: false,
            further_of: None,
        }
    }

    /// Sets the physical meaning of the effect in a machine, in one line.
    pub(crate) const fn summary(mut self, text: &'static str) -> Self {
        self.summary = text;
        self
    }

    /// Sets the equation of the effect, in plain characters.
    pub(crate) const fn equation(mut self, text: &'static str) -> Self {
        self.equation = text;
        self
    }

    /// Sets the source of the equation.
    pub(crate) const fn source(mut self, text: &'static str) -> Self {
        self.source = text;
        self
    }

    /// Sets the limits of validity of the equation.
    pub(crate) const fn limits(mut self, text: &'static str) -> Self {
        self.limits = text;
        self
    }

    /// Sets the name of the type in Rust.
    pub(crate) const fn rust_type(mut self, name: &'static str) -> Self {
        self.rust_type = name;
        self
    }

    /// Sets the descriptions of the parameters, in the order of their values.
    pub(crate) const fn parameters(mut self, parameters: &'static [Parameter]) -> Self {
        self.parameters = parameters;
        self
    }

    /// Sets the requirements on the law and the record.
    pub(crate) const fn needs(mut self, needs: &'static [Need]) -> Self {
        self.needs = needs;
        self
    }

    /// Marks the effect as a force that the transmission of the drive carries.
    pub(crate) const fn transmitted(mut self) -> Self {
        self.transmitted = true;
        self
    }

    /// Marks the effect as a second instance of the effect `of`.
    pub(crate) const fn further(mut self, of: &'static str) -> Self {
        self.further_of = Some(of);
        self
    }

    /// Checks the values of the parameters against their bounds.
    ///
    /// The null value of a parameter is always valid, even if it is infinite.
    ///
    /// # Errors
    /// Reports the first value that is missing or out of bounds, or more values than parameters.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), Error> {
        in_bounds(self.parameters, values)
    }

    /// Returns the first requirement that a law does not meet, if any; the effect then does not
    /// apply.
    pub fn lacking(&self, law: &law::Info) -> Option<Need> {
        self.needs.iter().copied().find(|need| !need.met_by(law))
    }

    /// Returns true if a parameter has its null value and this value is infinite.
    ///
    /// The effect must then be omitted, which is the only exact form of this limit.
    pub(crate) fn absent<T: Real>(&self, values: &[T]) -> bool {
        self.parameters.iter().zip(values).any(|(p, v)| {
            p.null
                .is_some_and(|null| !null.is_finite() && v.value() == null)
        })
    }
}

/// Effect of the catalogue, which is created from a list of values.
pub trait Named<T: Real>: Effect<T> {
    /// Description of the effect in the catalogue.
    const INFO: Info;

    /// Creates the effect from its parameters, in the order of `INFO.parameters`.
    ///
    /// # Errors
    /// Reports the first parameter that is missing, out of its bounds, or infinite where the effect
    /// vanishes. In the last case the effect must be omitted.
    fn build(values: &[T]) -> Result<Self, Error>;
}
