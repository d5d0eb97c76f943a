//! Description of one parameter of a law or an effect.
//!
//! The description is the single source of the name, the bounds, the start values of a fit, and the
//! behaviour under reflection.

use crate::error::{check, exactly, given, needed, within, ParameterError};
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

/// Quantity of the data from which a fit computes the start value of a parameter.
///
/// Machines differ in size, from a watch to a press, so most parameters of a law in newtons have no
/// common start value. The forces of other laws are proportional to the load; with these laws, the
/// start values of the catalogue apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Start values of the catalogue.
    Catalogue,
    /// Mean friction in motion.
    Kinetic,
    /// Friction at the start of motion (breakaway).
    Breakaway,
    /// Excess of friction at the start of motion over friction in motion.
    BreakawayExcess,
    /// Slope of friction over speed.
    Viscous,
    /// Low speed, over which friction falls (Stribeck speed).
    StribeckSpeed,
    /// Typical speed.
    UsualSpeed,
    /// Inverse of a typical speed.
    Slowness,
    /// Friction divided by the distance over which a contact deflects.
    Stiffness,
    /// Small fraction of a typical stroke.
    SlipDistance,
    /// Small fraction of friction divided by a typical speed.
    Damping,
    /// Small fraction of the friction in motion.
    Drag,
    /// Mass that explains the force during acceleration.
    Mass,
    /// Pitches (spatial periods) with which the force varies along the travel.
    Pitch,
    /// Pitches (spatial periods) with which the force in the direction of motion varies.
    RipplePitch,
    /// Fraction of the duration of a typical run.
    RunTime,
    /// Temperature for which the viscosity of the rig is given, otherwise the mean recorded
    /// temperature, C.
    ReferenceTemperature,
    /// Half-width of a load-cell hysteresis: a small fraction of the largest recorded force.
    CellPlay,
    /// Cubic coefficient that corresponds to a small nonlinearity at the largest recorded force.
    CellCubic,
    /// Middle of the travel of the runs.
    StrokeMiddle,
    /// Half of the travel of the runs.
    StrokeHalf,
    /// Start values of the catalogue, and smaller values down to a fraction of the sampling
    /// interval.
    Lateness,
    /// Backlash of a small fraction of a stroke, on a linear axis.
    DrivePlay,
    /// Stiffness of a drive that deflects by a small fraction of a stroke, on a linear axis.
    DriveStiffness,
    /// Mass that oscillates fast relative to a stroke, on a linear axis.
    DriveInertia,
    /// Damping that is considerable at a typical speed, on a linear axis.
    DriveDamping,
}

impl Start {
    /// Returns the name used in files and in Python.
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
            Start::Mass => "mass",
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

/// Upper bound of a parameter in a fit, in addition to the bounds of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// No additional bound.
    Catalogue,
    /// Highest recorded speed, for the speed at which a film carries the whole load.
    ///
    /// Values far above the recorded speeds have no visible effect.
    TransitionSpeed,
}

impl Bound {
    /// Returns the name used in files and in Python.
    pub const fn name(self) -> &'static str {
        match self {
            Bound::Catalogue => "catalogue",
            Bound::TransitionSpeed => "transition_speed",
        }
    }
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
    /// Quantity of the data from which a fit computes the start value.
    pub start: Start,
    /// Upper bound in a fit, in addition to `upper`.
    pub bound: Bound,
    /// True for a parameter that is specified instead of estimated.
    ///
    /// A fit holds such a parameter at its start value, or at a value given by the user. The
    /// parameter is a reference for others, or records do not determine it in addition to them.
    pub stated: bool,
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
            start: Start::Catalogue,
            bound: Bound::Catalogue,
            stated: false,
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

    /// Sets the quantity of the data from which a fit computes the start value.
    pub(crate) const fn start(mut self, start: Start) -> Self {
        self.start = start;
        self
    }

    /// Marks the parameter as one that is specified instead of estimated.
    pub(crate) const fn stated(mut self) -> Self {
        self.stated = true;
        self
    }

    /// Sets the quantity of the data that limits the parameter in a fit.
    pub(crate) const fn bound(mut self, bound: Bound) -> Self {
        self.bound = bound;
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
pub(crate) fn in_bounds<T: Real>(
    parameters: &[Parameter],
    values: &[T],
) -> Result<(), ParameterError> {
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
) -> Result<[T; N], ParameterError> {
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
