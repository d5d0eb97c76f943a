//! Description of a law in the catalogue, and the construction of laws by name.

use super::Law;
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::ParameterError;
use crate::page::{in_bounds, Parameter};
use crate::real::Real;

/// Description of one law.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Fixed name, as used in files and options.
    pub name: &'static str,
    /// Physical meaning, in one line.
    pub summary: &'static str,
    /// Equation, in plain characters.
    pub equation: &'static str,
    /// Source of the equation.
    pub source: &'static str,
    /// Limits of validity of the equation.
    pub limits: &'static str,
    /// Parameters, in order.
    pub parameters: &'static [Parameter],
    /// True if the law is computed from the geometry, lubricant and load of a bearing; other laws
    /// return newtons and require none.
    pub needs_bearing: bool,
    /// True if the law has a lubricant film, which can warm up or thin.
    pub has_film: bool,
    /// True if the law deflects before it slides and has no jump at zero speed.
    ///
    /// It is defined by [`Law::HAS_BRISTLE`] and repeated here.
    pub has_bristle: bool,
    /// True if friction depends on motion before the last step.
    ///
    /// It is defined by [`Law::HAS_MEMORY`] and repeated here.
    pub has_memory: bool,
    /// True if the law contains a dry friction `F sgn(v)` that is independent of the load and jumps
    /// at zero speed.
    ///
    /// A second such term would not be distinguishable from it.
    pub has_dry_level: bool,
}

impl Info {
    /// Creates an empty description of the law `L`, a law in newtons without a film.
    pub const fn new<T: Real, L: Law<T>>(name: &'static str) -> Self {
        Self {
            name,
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

    /// Sets the physical meaning, in one line.
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

    /// Marks a law that is computed from the geometry, lubricant and load of a bearing.
    pub const fn on_a_bearing(mut self) -> Self {
        self.needs_bearing = true;
        self
    }

    /// Marks a law with a lubricant film.
    pub const fn with_a_film(mut self) -> Self {
        self.has_film = true;
        self
    }

    /// Marks a law with a dry friction that is independent of the load.
    pub const fn with_a_dry_level(mut self) -> Self {
        self.has_dry_level = true;
        self
    }

    /// Checks a list of values against the bounds.
    ///
    /// # Errors
    /// Names the first value that is missing or out of bounds.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), ParameterError> {
        in_bounds(self.parameters, values)
    }
}

/// A law of the catalogue, which is built from a list of values.
pub trait Named<T: Real>: Law<T> + Copy + Send + Sync + 'static {
    /// Description in the catalogue.
    const INFO: Info;

    /// Creates the law from its parameters, in the order of `INFO.parameters`.
    ///
    /// A law that needs no bearing ignores the bearing, the load and the clock.
    ///
    /// # Errors
    /// Names the first number that violates its rule. A missing bearing or load is reported as the
    /// parameter `bearing` or `load_n`.
    fn build(
        bearing: Option<&Bearing>,
        load_n: Option<f64>,
        values: &[T],
        clock: Clock,
    ) -> Result<Self, ParameterError>;
}

/// A law with a curve of steady friction against speed.
pub trait SteadyCurve {
    /// Steady friction at one speed (m/s, not zero), N, with the sign of the speed, under the load
    /// that the law was built with.
    ///
    /// # Errors
    /// The speed must be finite and not zero: at rest friction is set-valued.
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, ParameterError>;
}

/// Operation on a law of any type; see [`super::with_law`].
pub trait Visitor<T: Real> {
    /// Result of the operation.
    type Output;

    /// Performs the operation.
    fn visit<L: Named<T>>(self, law: L) -> Self::Output;
}
