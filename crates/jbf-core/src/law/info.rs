//! Description of a law in the catalogue, and the construction of laws by name.

use super::Law;
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::Error;
use crate::parameter::{in_bounds, Parameter};
use crate::real::Real;

/// Description of a law in the catalogue.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Unique name of the law in files and options.
    pub name: &'static str,
    /// Name of the type in Rust: `law::NAME::RUST_TYPE`.
    pub rust_type: &'static str,
    /// Physical meaning of the law, in one line.
    pub summary: &'static str,
    /// Equation of the law, in plain characters.
    pub equation: &'static str,
    /// Source of the equation.
    pub source: &'static str,
    /// Limits of validity of the equation.
    pub limits: &'static str,
    /// Descriptions of the parameters, in the order of their values.
    pub parameters: &'static [Parameter],
    /// True if the law is computed from the geometry, lubricant and load of a bearing; other laws
    /// return newtons.
    pub needs_bearing: bool,
    /// True if the law has a lubricant film, which can warm up or thin.
    pub has_film: bool,
    /// True if the law deflects before it slides and has no jump at zero speed.
    ///
    /// The value is that of [`Law::HAS_BRISTLE`].
    pub has_bristle: bool,
    /// True if friction depends on motion before the last step.
    ///
    /// The value is that of [`Law::HAS_MEMORY`].
    pub has_memory: bool,
    /// True if the law has a dry friction `F sgn(v)` that is independent of the load and jumps at
    /// zero speed.
    ///
    /// A second such term would not be distinguishable from it.
    pub has_dry_level: bool,
}

impl Info {
    /// Creates a description of the law `L` without parameters, as a law in newtons without a film.
    pub(crate) const fn new<T: Real, L: Law<T>>(name: &'static str) -> Self {
        Self {
            name,
            rust_type: "",
            summary: "",
            equation: "",
            source: "",
            limits: "",
            parameters: &[],
            needs_bearing: false,
            has_film: false,
            has_bristle: L::HAS_BRISTLE,
            has_memory: L::HAS_MEMORY,
            has_dry_level: false,
        }
    }

    /// Sets the physical meaning of the law, in one line.
    pub(crate) const fn summary(mut self, text: &'static str) -> Self {
        self.summary = text;
        self
    }

    /// Sets the equation of the law, in plain characters.
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

    /// Marks the law as one that is computed from the geometry, lubricant and load of a bearing.
    pub(crate) const fn on_a_bearing(mut self) -> Self {
        self.needs_bearing = true;
        self
    }

    /// Marks the law as one with a lubricant film.
    pub(crate) const fn with_a_film(mut self) -> Self {
        self.has_film = true;
        self
    }

    /// Marks the law as one with a dry friction that is independent of the load.
    pub(crate) const fn with_a_dry_level(mut self) -> Self {
        self.has_dry_level = true;
        self
    }

    /// Checks the values of the parameters against their bounds.
    ///
    /// # Errors
    /// Reports the first value that is missing or out of bounds, or more values than parameters.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), Error> {
        in_bounds(self.parameters, values)
    }
}

/// Law of the catalogue, which is created from a list of values.
pub trait Named<T: Real>: Law<T> + Copy + Send + Sync + 'static {
    /// Description of the law in the catalogue.
    const INFO: Info;

    /// Creates the law from its parameters, in the order of `INFO.parameters`.
    ///
    /// A law in newtons ignores the bearing, the load and the time scale of the film.
    ///
    /// # Errors
    /// Reports the first number that violates its rule. A missing bearing or load is reported as
    /// the parameter `bearing` or `load_n`.
    fn build(
        bearing: Option<&Bearing>,
        load_n: Option<f64>,
        values: &[T],
        clock: Clock,
    ) -> Result<Self, Error>;
}

/// Law with a steady friction at each speed.
pub trait SteadyCurve {
    /// Returns the steady friction at one speed (m/s, not zero), N, with the sign of the speed,
    /// under the load with which the law was created.
    ///
    /// # Errors
    /// The speed must be finite and not zero: at rest friction is set-valued.
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error>;
}

/// Operation on a law whose type is selected by name at run time; see [`super::with_law`].
pub trait Visitor<T: Real> {
    /// Result of the operation.
    type Output;

    /// Performs the operation on a law.
    fn visit<L: Named<T>>(self, law: L) -> Self::Output;
}
