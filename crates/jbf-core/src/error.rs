//! One error for every constructor: which parameter, which value, which rule.

use core::fmt;

/// A parameter that breaks its rule.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ParameterError {
    /// Name of the parameter, with its unit (`radius_m`).
    pub name: &'static str,
    /// The value that was given.
    pub value: f64,
    /// The rule that it breaks (`must be positive and finite`).
    pub rule: &'static str,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {} {}", self.name, self.value, self.rule)
    }
}

impl core::error::Error for ParameterError {}

/// Check one rule; the error carries name, value and rule.
pub(crate) fn check(
    ok: bool,
    name: &'static str,
    value: f64,
    rule: &'static str,
) -> Result<(), ParameterError> {
    if ok {
        Ok(())
    } else {
        Err(ParameterError { name, value, rule })
    }
}

/// Most physical sizes: finite and above zero.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), ParameterError> {
    check(
        value > 0.0 && value.is_finite(),
        name,
        value,
        "must be positive and finite",
    )
}
