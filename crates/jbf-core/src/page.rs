//! Description of one parameter of a law or an effect.
//!
//! It is the single source of its name, its bounds, the start values of a fit, and its behaviour
//! under reflection.

use crate::error::{given, within, ParameterError};
use crate::real::Real;

/// Behaviour of a parameter when the machine is reflected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// The parameter does not change.
    Same,
    /// The parameter changes sign: an angle, a force with a direction, a difference of two
    /// directions.
    Negate,
}

/// Start value in a fit of a law in newtons.
///
/// No single scale suits both a watch and a press, so most parameters of such a law name the
/// quantity of the data that gives their order of magnitude. A law that scales with the load has no
/// forces of its own; with it the catalogue's values apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// The catalogue's values.
    Catalogue,
    /// Friction in motion.
    Kinetic,
    /// Friction at the start of motion.
    Breakaway,
    /// Excess of friction at the start of motion over friction in motion.
    BreakawayExcess,
    /// Slope of friction over speed.
    Viscous,
    /// A low speed, over which friction falls.
    StribeckSpeed,
    /// A typical speed.
    UsualSpeed,
    /// Inverse of a typical speed.
    Slowness,
    /// Friction per distance over which a contact deflects.
    Stiffness,
    /// A small share of a typical stroke.
    SlipDistance,
    /// A small share of friction per typical speed.
    Damping,
    /// A small share of friction in motion.
    Drag,
    /// Pitches at which the force repeats along the travel.
    Pitch,
    /// Pitches at which the force in the direction of motion repeats.
    RipplePitch,
    /// A share of the duration of a typical run.
    RunTime,
    /// Temperature at which the viscosity of the rig is valid, otherwise the mean recorded
    /// temperature, C.
    ReferenceTemperature,
    /// A small share of the largest recorded force.
    CellPlay,
    /// Nonlinearity of a load cell by a small share at the largest recorded force.
    CellCubic,
    /// Middle of the travel of the runs.
    StrokeMiddle,
    /// Half of the travel of the runs.
    StrokeHalf,
    /// The catalogue's values, and values down to the resolution of a sample.
    Lateness,
    /// On a linear axis: a backlash of a small share of a stroke.
    DrivePlay,
    /// On a linear axis: a drive that deflects by a small share of a stroke.
    DriveStiffness,
    /// On a linear axis: a drive that rings fast relative to a stroke.
    DriveInertia,
    /// On a linear axis: a drive that damps at a typical speed.
    DriveDamping,
}

impl Start {
    /// Name used in files and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Start::Catalogue => "catalogue",
            Start::Kinetic => "kinetic",
            Start::Breakaway => "breakaway",
            Start::BreakawayExcess => "breakaway_excess",
            Start::Viscous => "viscous",
            Start::StribeckSpeed => "stribeck_speed",
            Start::UsualSpeed => "usual_speed",
            Start::Slowness => "slowness",
            Start::Stiffness => "stiffness",
            Start::SlipDistance => "slip_distance",
            Start::Damping => "damping",
            Start::Drag => "drag",
            Start::Pitch => "pitch",
            Start::RipplePitch => "ripple_pitch",
            Start::RunTime => "run_time",
            Start::ReferenceTemperature => "reference_temperature",
            Start::CellPlay => "cell_play",
            Start::CellCubic => "cell_cubic",
            Start::StrokeMiddle => "stroke_middle",
            Start::StrokeHalf => "stroke_half",
            Start::Lateness => "lateness",
            Start::DrivePlay => "drive_play",
            Start::DriveStiffness => "drive_stiffness",
            Start::DriveInertia => "drive_inertia",
            Start::DriveDamping => "drive_damping",
        }
    }
}

/// Upper bound of a parameter in a fit, in addition to the catalogue's bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// No additional bound.
    Catalogue,
    /// The highest recorded speed.
    ///
    /// The parameter is the speed at which a film carries the load alone. Values far beyond the
    /// record have no visible effect.
    TransitionSpeed,
}

impl Bound {
    /// Name used in files and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Bound::Catalogue => "catalogue",
            Bound::TransitionSpeed => "transition_speed",
        }
    }
}

/// One parameter of a law or an effect.
///
/// ```
/// use jbf_core::page::{Mirror, Parameter};
/// const B: Parameter = Parameter::new("b", "N", "reading without force", [-1e5, 1e5], &[0.3])
///     .null(0.0)
///     .signed();
/// assert_eq!((B.null, B.mirror, B.log), (Some(0.0), Mirror::Negate, false));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parameter {
    /// Name in files and options: the symbol (`sigma`), followed by the unit if it is the same on
    /// every rig (`tau_s`).
    pub name: &'static str,
    /// Unit in conventional notation (`1/m`).
    pub unit: &'static str,
    /// Meaning of the parameter.
    pub meaning: &'static str,
    /// Smallest value allowed.
    pub lower: f64,
    /// Largest value allowed.
    pub upper: f64,
    /// Value at which the effect vanishes, if this parameter has one.
    pub null: Option<f64>,
    /// Start values of a fit, likeliest first.
    pub starts: &'static [f64],
    /// True if a fit should use the logarithm of the parameter.
    pub log: bool,
    /// Period of an angle, for parameters that wrap.
    pub period: Option<f64>,
    /// Behaviour under reflection.
    pub mirror: Mirror,
    /// Start value in a fit of a law in newtons.
    pub start: Start,
    /// Upper bound in a fit.
    pub bound: Bound,
    /// True for a parameter that is specified instead of estimated.
    ///
    /// A fit holds it at its start value, or at a value given by the user. It defines the terms of
    /// other parameters (a reference), or belongs to a form with one parameter more than records
    /// determine.
    pub stated: bool,
}

impl Parameter {
    /// Creates a parameter between two bounds, without a null value and not logarithmic.
    pub const fn new(
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
            start: Start::Catalogue,
            bound: Bound::Catalogue,
            stated: false,
        }
    }

    /// Marks a scale: a fit uses its logarithm.
    pub const fn log(mut self) -> Self {
        self.log = true;
        self
    }

    /// Sets the value at which the effect vanishes.
    pub const fn null(mut self, value: f64) -> Self {
        self.null = Some(value);
        self
    }

    /// Marks an angle that wraps.
    pub const fn period(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// Marks a parameter that changes sign under reflection.
    pub const fn signed(mut self) -> Self {
        self.mirror = Mirror::Negate;
        self
    }

    /// Sets the quantity of the data that gives its order of magnitude.
    pub const fn start(mut self, start: Start) -> Self {
        self.start = start;
        self
    }

    /// Marks a parameter that is specified instead of estimated.
    pub const fn stated(mut self) -> Self {
        self.stated = true;
        self
    }

    /// Sets the quantity of the data that bounds it.
    pub const fn bound(mut self, bound: Bound) -> Self {
        self.bound = bound;
        self
    }
}

/// True if there is one value per parameter and each is within its bounds or at its null.
///
/// It can check constants at compile time.
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

/// Compares two names; usable at compile time.
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

/// Checks values against the bounds of their descriptions.
///
/// A null value is always allowed.
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
