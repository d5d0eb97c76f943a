//! The catalogue's page of an effect: the one source for the command line, the docs and
//! the fit's bounds and starting values.

use super::need::Need;
use crate::error::{given, within, ParameterError};
use crate::law;
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

/// One parameter of a law or an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Symbol and unit as one name (`sigma_1_m`), as files and options spell it.
    pub name: &'static str,
    /// Unit as people write it (`1/m`).
    pub unit: &'static str,
    /// What it is.
    pub meaning: &'static str,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// The value at which the effect vanishes, where this parameter has one.
    pub null: Option<f64>,
    /// Where a fit may start, likeliest first.
    pub starts: &'static [f64],
    /// True where a fit should walk in the logarithm.
    pub log: bool,
    /// The period of an angle, for parameters that wrap.
    pub period: Option<f64>,
}

/// The page of one effect.
#[derive(Clone, Copy, Debug)]
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
}

impl Info {
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

/// True where there is one value for each parameter and each lies in its bounds or at its null:
/// what can be checked of constants while a program is compiled.
pub(crate) const fn values_fit(pages: &[Parameter], values: &[f64]) -> bool {
    if pages.len() != values.len() {
        return false;
    }
    let mut i = 0;
    while i < values.len() {
        let (page, value) = (&pages[i], values[i]);
        let at_null = match page.null {
            Some(null) => value == null,
            None => false,
        };
        let within = at_null || (value >= page.lower && value <= page.upper);
        if !within {
            return false;
        }
        i += 1;
    }
    true
}

/// Two names, while a program is compiled.
pub(crate) const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}

/// Check values against the bounds of their pages. A null value is always allowed.
///
/// # Errors
/// Names the first value that is missing or out of bounds.
pub(crate) fn in_bounds<T: Real>(pages: &[Parameter], values: &[T]) -> Result<(), ParameterError> {
    for (i, p) in pages.iter().enumerate() {
        let value = given(values, i, p.name)?.value();
        if p.null != Some(value) {
            within(p.name, value, [p.lower, p.upper])?;
        }
    }
    Ok(())
}
