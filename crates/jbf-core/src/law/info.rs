//! The catalogue's page of a law, and how every law of the catalogue is built.

use super::Law;
use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::ParameterError;
use crate::page::{in_bounds, Parameter};
use crate::real::Real;

/// The page of one law.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Info {
    /// Fixed name, as files and options spell it.
    pub name: &'static str,
    /// One line: what it describes.
    pub summary: &'static str,
    /// The form, in plain characters.
    pub equation: &'static str,
    /// Where the form comes from.
    pub source: &'static str,
    /// Where the form stops being true.
    pub limits: &'static str,
    /// Parameters in order.
    pub parameters: &'static [Parameter],
    /// True where the law computes from a bearing's geometry, lubricant and load; the others
    /// give newtons and need none.
    pub needs_bearing: bool,
    /// True where the law has a lubricant film, which can warm or thin.
    pub has_film: bool,
    /// True where the law bends before it slides: it has no jump at zero speed. Only
    /// [`Law::HAS_BRISTLE`] says so; the page repeats it.
    pub has_bristle: bool,
    /// True where the law already holds a dry friction `F sgn(v)` that depends on no load and
    /// jumps at zero speed: a second one beside it could not be told from it.
    pub has_dry_level: bool,
}

impl Info {
    /// The page of the law `L`, to be filled in: of a law in newtons, without a film.
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
            has_dry_level: false,
        }
    }

    /// What it describes, in one line.
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

    /// It computes from a bearing's geometry, lubricant and load.
    pub const fn on_a_bearing(mut self) -> Self {
        self.needs_bearing = true;
        self
    }

    /// It has a lubricant film.
    pub const fn with_a_film(mut self) -> Self {
        self.has_film = true;
        self
    }

    /// It holds a dry friction that depends on no load.
    pub const fn with_a_dry_level(mut self) -> Self {
        self.has_dry_level = true;
        self
    }

    /// Check a list of values against the bounds.
    ///
    /// # Errors
    /// Names the first value that is missing or out of bounds.
    pub fn check<T: Real>(&self, values: &[T]) -> Result<(), ParameterError> {
        in_bounds(self.parameters, values)
    }
}

/// A law of the catalogue: built from a list of values, whatever it is.
pub trait Named<T: Real>: Law<T> + Copy + Send + Sync + 'static {
    /// The page in the catalogue.
    const INFO: Info;

    /// Build from the parameters in the order of `INFO.parameters`. A law that needs no
    /// bearing ignores the first two and the clock.
    ///
    /// # Errors
    /// Names the first number that breaks its rule; what a law needs of a bearing and was not
    /// given is reported as the parameter `bearing` or `load_n`.
    fn build(
        bearing: Option<&Bearing>,
        load_n: Option<f64>,
        values: &[T],
        clock: Clock,
    ) -> Result<Self, ParameterError>;
}

/// A law with a curve of steady friction against speed.
pub trait SteadyCurve {
    /// Friction after a long time at one speed (m/s, not zero), N, with the sign of the speed;
    /// under the load that the law was built with.
    ///
    /// # Errors
    /// The speed must be finite and not zero: at rest friction is set-valued.
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, ParameterError>;
}

/// Something to do with a law of any kind; see [`super::with_law`].
pub trait Visitor<T: Real> {
    /// What comes of it.
    type Output;

    /// Do it.
    fn visit<L: Named<T>>(self, law: L) -> Self::Output;
}
