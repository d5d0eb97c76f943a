//! Error type of all constructors: the parameter, its value and the violated rule.

use core::fmt;

/// Reason why a constructor failed.
///
/// An error is displayed as one line in lower case with the parameter, the value and the rule:
/// `radius_m = -1 must be positive and finite`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error {
    /// The catalogue has no law with this name.
    UnknownLaw,
    /// The catalogue has no effect with this name.
    UnknownEffect,
    /// A required value is missing.
    Missing {
        /// Name of the parameter, with its unit (`load_n`).
        name: &'static str,
    },
    /// A list has fewer values than parameters.
    TooFew {
        /// Name of the list of values.
        name: &'static str,
        /// Number of values given.
        given: usize,
        /// Number of values required.
        needed: usize,
    },
    /// A list has more values than parameters.
    TooMany {
        /// Name of the list of values.
        name: &'static str,
        /// Number of values given.
        given: usize,
        /// Number of values required.
        needed: usize,
    },
    /// The value must be positive and finite.
    NotPositive {
        /// Name of the parameter, with its unit (`radius_m`).
        name: &'static str,
        /// Given value.
        value: f64,
    },
    /// The value must be zero or positive, and finite.
    Negative {
        /// Name of the parameter, with its unit.
        name: &'static str,
        /// Given value.
        value: f64,
    },
    /// The value must be finite.
    NotFinite {
        /// Name of the parameter, with its unit.
        name: &'static str,
        /// Given value.
        value: f64,
    },
    /// The value is outside the bounds of its parameter, or NaN.
    OutOfBounds {
        /// Name of the parameter, with its unit.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Smallest permitted value.
        lower: f64,
        /// Largest permitted value.
        upper: f64,
    },
    /// The value violates another rule of a single parameter.
    Rule {
        /// Name of the parameter, with its unit.
        name: &'static str,
        /// Given value.
        value: f64,
        /// Rule that the value violates (`must be smaller than radius_m`).
        rule: &'static str,
    },
}

impl Error {
    /// Returns the name of the parameter that violates its rule; `law` or `effect` for an unknown
    /// name.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match *self {
            Error::UnknownLaw => "law",
            Error::UnknownEffect => "effect",
            Error::Missing { name }
            | Error::TooFew { name, .. }
            | Error::TooMany { name, .. }
            | Error::NotPositive { name, .. }
            | Error::Negative { name, .. }
            | Error::NotFinite { name, .. }
            | Error::OutOfBounds { name, .. }
            | Error::Rule { name, .. } => name,
        }
    }

    /// Returns the refused value, if any.
    #[must_use]
    pub const fn value(&self) -> Option<f64> {
        match *self {
            Error::UnknownLaw | Error::UnknownEffect | Error::Missing { .. } => None,
            Error::TooFew { given, .. } | Error::TooMany { given, .. } => Some(given as f64),
            Error::NotPositive { value, .. }
            | Error::Negative { value, .. }
            | Error::NotFinite { value, .. }
            | Error::OutOfBounds { value, .. }
            | Error::Rule { value, .. } => Some(value),
        }
    }

    /// Returns the violated rule, without its numbers.
    #[must_use]
    pub const fn rule(&self) -> &'static str {
        match *self {
            Error::UnknownLaw | Error::UnknownEffect => "is not in the catalogue",
            Error::Missing { .. } => "is missing",
            Error::TooFew { .. } => "are too few",
            Error::TooMany { .. } => "are too many",
            Error::NotPositive { .. } => "must be positive and finite",
            Error::Negative { .. } => "must be zero or positive, and finite",
            Error::NotFinite { .. } => "must be finite",
            Error::OutOfBounds { .. } => "is outside its bounds",
            Error::Rule { rule, .. } => rule,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, rule) = (self.name(), self.rule());
        match *self {
            Error::OutOfBounds {
                value,
                lower,
                upper,
                ..
            } => write!(f, "{name} = {value} must lie between {lower} and {upper}"),
            Error::TooFew { given, needed, .. } => {
                write!(f, "{name} {rule}: {given} of {needed}")
            }
            Error::TooMany { given, needed, .. } => {
                write!(f, "{name} {rule}: {given} instead of {needed}")
            }
            _ => match self.value() {
                Some(value) => write!(f, "{name} = {value} {rule}"),
                None => write!(f, "{name} {rule}"),
            },
        }
    }
}

impl core::error::Error for Error {}

/// Returns an [`Error::Rule`] with the parameter's name, value and rule unless `ok` is true.
pub(crate) fn check(
    ok: bool,
    name: &'static str,
    value: f64,
    rule: &'static str,
) -> Result<(), Error> {
    if ok {
        Ok(())
    } else {
        Err(Error::Rule { name, value, rule })
    }
}

/// Checks that a value is positive and finite, as most physical sizes are.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), Error> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::NotPositive { name, value })
    }
}

/// Checks that a value is finite and zero or positive.
pub(crate) fn not_negative(name: &'static str, value: f64) -> Result<(), Error> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(Error::Negative { name, value })
    }
}

/// Checks that a value of either sign is finite.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<(), Error> {
    if value.is_finite() {
        Ok(())
    } else {
        Err(Error::NotFinite { name, value })
    }
}

/// Checks that a value is within inclusive bounds.
pub(crate) fn within(
    name: &'static str,
    value: f64,
    [lower, upper]: [f64; 2],
) -> Result<(), Error> {
    if value >= lower && value <= upper {
        Ok(())
    } else {
        Err(Error::OutOfBounds {
            name,
            value,
            lower,
            upper,
        })
    }
}

/// Returns a required value, or reports it as missing.
pub(crate) fn needed<V>(name: &'static str, value: Option<V>) -> Result<V, Error> {
    value.ok_or(Error::Missing { name })
}

/// Returns the value of one parameter in a list.
pub(crate) fn given<T: Copy>(values: &[T], i: usize, name: &'static str) -> Result<T, Error> {
    needed(name, values.get(i).copied())
}

/// Checks that a list has one value for each of the parameters.
///
/// Two comparisons instead of an ordering let the compiler omit the bounds checks of the caller.
#[inline(always)]
pub(crate) fn exactly(name: &'static str, given: usize, needed: usize) -> Result<(), Error> {
    if given < needed {
        return Err(Error::TooFew {
            name,
            given,
            needed,
        });
    }
    if given > needed {
        return Err(Error::TooMany {
            name,
            given,
            needed,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    #[test]
    fn error_message_has_parameter_value_and_rule() {
        for (error, said) in [
            (Error::UnknownLaw, "law is not in the catalogue"),
            (Error::UnknownEffect, "effect is not in the catalogue"),
            (Error::Missing { name: "load_n" }, "load_n is missing"),
            (
                Error::TooFew {
                    name: "parameters",
                    given: 2,
                    needed: 4,
                },
                "parameters are too few: 2 of 4",
            ),
            (
                exactly("parameters", 5, 4).expect_err("one more"),
                "parameters are too many: 5 instead of 4",
            ),
            (
                positive("radius_m", -1.0).expect_err("negative"),
                "radius_m = -1 must be positive and finite",
            ),
            (
                not_negative("volts_per_n", f64::INFINITY).expect_err("infinite"),
                "volts_per_n = inf must be zero or positive, and finite",
            ),
            (
                finite("bias_m_s", f64::NAN).expect_err("no number"),
                "bias_m_s = NaN must be finite",
            ),
            (
                within("smooth", 0.6, [0.0, 0.5]).expect_err("outside"),
                "smooth = 0.6 must lie between 0 and 0.5",
            ),
            (
                check(false, "count", 0.0, "must be at least 1").expect_err("none"),
                "count = 0 must be at least 1",
            ),
        ] {
            assert_eq!(error.to_string(), said);
            assert!(said.contains(error.name()), "{said}");
        }
    }

    #[test]
    fn range_checks_accept_closed_ends_and_refuse_open_ends() {
        assert!(positive("x", 0.0).is_err() && positive("x", f64::MIN_POSITIVE).is_ok());
        assert!(positive("x", f64::INFINITY).is_err() && positive("x", f64::NAN).is_err());
        assert!(not_negative("x", 0.0).is_ok() && not_negative("x", -1e-300).is_err());
        assert!(finite("x", f64::MAX).is_ok() && finite("x", f64::INFINITY).is_err());
        assert!(within("x", 0.0, [0.0, 1.0]).is_ok() && within("x", 1.0, [0.0, 1.0]).is_ok());
        assert!(within("x", f64::NAN, [0.0, 1.0]).is_err());
    }
}
