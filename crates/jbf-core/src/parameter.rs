//! Description of one parameter of a law or an effect.
//!
//! The description is the single source of the name, the bounds, the usual values and the behaviour
//! under reflection.

use crate::error::{check, exactly, given, needed, within, Error};
use crate::real::Real;

/// Behaviour of a parameter under reflection of the machine, which reverses every direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// The parameter does not change.
    Same,
    /// The parameter changes sign: an angle, a force with a direction, a difference of two
    /// directions.
    Negate,
}

/// Description of one parameter of a law or an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Name in files and options: the symbol (`sigma`), followed by the unit if it is the same on
    /// every rig (`tau_s`).
    pub name: &'static str,
    /// Unit in conventional notation (`1/m`).
    pub unit: &'static str,
    /// Physical meaning of the parameter.
    pub meaning: &'static str,
    /// Smallest permitted value.
    pub lower: f64,
    /// Largest permitted value.
    pub upper: f64,
    /// Value at which the effect vanishes, if there is one.
    pub null: Option<f64>,
    /// Start values of a fit, the most likely first.
    pub starts: &'static [f64],
    /// True if a fit uses the logarithm of the parameter.
    pub log: bool,
    /// Period of an angle that is periodic.
    pub period: Option<f64>,
    /// Behaviour under reflection of the machine.
    pub mirror: Mirror,
}

impl Parameter {
    /// Creates a parameter between two bounds, without a null value and not logarithmic.
    pub(crate) const fn new(
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        bounds: [f64; 2],
        starts: &'static [f64],
    ) -> Self {
        Self {
            name,
            unit,
            meaning,
            lower: bounds[0],
            upper: bounds[1],
            null: None,
            starts,
            log: false,
            period: None,
            mirror: Mirror::Same,
        }
    }

    /// Marks the parameter as a positive quantity whose logarithm is fitted.
    pub(crate) const fn log(mut self) -> Self {
        self.log = true;
        self
    }

    /// Sets the value at which the effect vanishes.
    pub(crate) const fn null(mut self, value: f64) -> Self {
        self.null = Some(value);
        self
    }

    /// Marks the parameter as an angle with a period.
    pub(crate) const fn period(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// Marks the parameter as one that changes sign under reflection.
    pub(crate) const fn signed(mut self) -> Self {
        self.mirror = Mirror::Negate;
        self
    }
}

/// Returns true if there is one value per parameter and each is within its bounds or at its null
/// value, which must be finite: an effect with an infinite null value must be omitted.
///
/// The function can check constants at compile time.
pub(crate) const fn values_fit(parameters: &[Parameter], values: &[f64]) -> bool {
    if parameters.len() != values.len() {
        return false;
    }
    let mut i = 0;
    while i < values.len() {
        let (parameter, value) = (&parameters[i], values[i]);
        let at_null = match parameter.null {
            Some(null) => null.is_finite() && value == null,
            None => false,
        };
        let within = at_null || (value >= parameter.lower && value <= parameter.upper);
        if !within {
            return false;
        }
        i += 1;
    }
    true
}

/// Returns true if two names are equal apart from the case of letters; usable at compile time.
pub(crate) const fn equal_ignoring_case(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if !a[i].eq_ignore_ascii_case(&b[i]) {
            return false;
        }
        i += 1;
    }
    true
}

/// Checks values against the bounds of their parameters.
///
/// The null value of a parameter is always valid.
///
/// # Errors
/// Reports the first value that is missing or out of bounds, or more values than parameters.
pub(crate) fn in_bounds<T: Real>(parameters: &[Parameter], values: &[T]) -> Result<(), Error> {
    for (i, p) in parameters.iter().enumerate() {
        let value = given(values, i, p.name)?.value();
        if p.null != Some(value) {
            within(p.name, value, [p.lower, p.upper])?;
        }
    }
    exactly("parameters", values.len(), parameters.len())
}

/// Returns the values that `Parameters::default()` of a law or an effect has.
///
/// A parameter has the value without effect where there is a finite one, and otherwise the first
/// start value of a fit.
pub(crate) fn defaults<const N: usize>(parameters: &[Parameter; N]) -> [f64; N] {
    parameters.each_ref().map(|parameter| match parameter.null {
        Some(null) if null.is_finite() => null,
        _ => parameter.starts[0],
    })
}

/// Returns the values, one per parameter, each checked against its bounds.
///
/// # Errors
/// Reports the first value that is missing, out of its bounds, or infinite where the effect
/// vanishes (the effect must be omitted in this case), or more values than parameters.
pub(crate) fn checked<T: Real, const N: usize>(
    parameters: &[Parameter; N],
    values: &[T],
) -> Result<[T; N], Error> {
    for (parameter, value) in parameters.iter().zip(values) {
        let infinite = parameter.null.is_some_and(|null| !null.is_finite());
        check(
            !infinite || parameter.null != Some(value.value()),
            parameter.name,
            value.value(),
            "is the value at which the effect vanishes: omit the effect",
        )?;
    }
    in_bounds(parameters, values)?;
    let values = values.first_chunk();
    needed("parameters", values.copied())
}
