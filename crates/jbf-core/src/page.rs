//! The page of one parameter, of a law or an effect: the one source of its name, its bounds, where a
//! fit may start and what a mirror does to it.

use crate::error::{given, within, ParameterError};
use crate::real::Real;

/// What becomes of a parameter where the machine is looked at in a mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// It is the same.
    Same,
    /// It changes its sign: an angle, a force with a direction, a difference between two ways.
    Negate,
}

/// Where a fit of a law in newtons may start: such a law has no one scale that suits a watch and a
/// press, so most of its parameters say of what in the data they are about the size. A law that
/// scales with the load knows no newtons; beside it the catalogue's values hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// At the catalogue's values.
    Catalogue,
    /// Friction in motion.
    Kinetic,
    /// Friction as motion begins.
    Breakaway,
    /// What friction as motion begins has more than in motion.
    BreakawayExcess,
    /// The slope of friction over speed.
    Viscous,
    /// A slow speed, over which friction falls.
    StribeckSpeed,
    /// A usual speed.
    UsualSpeed,
    /// One over a usual speed.
    Slowness,
    /// Friction over the distance in which a contact bends.
    Stiffness,
    /// Friction over a usual speed, a small share of it.
    Damping,
    /// A small share of friction in motion.
    Drag,
    /// Pitches at which the force comes again along the way.
    Pitch,
    /// Pitches at which the force in the direction of motion does.
    RipplePitch,
    /// A share of a usual run's time.
    RunTime,
    /// The temperature at which a rig's viscosity holds, or else the mean of those on record, C.
    ReferenceTemperature,
    /// A small share of the largest force on record.
    CellPlay,
    /// What bends a cell's line by a small share at the largest force on record.
    CellCubic,
    /// The middle of the way that the runs cover.
    StrokeMiddle,
    /// Half of that way.
    StrokeHalf,
    /// At the catalogue's values, and down to what a sample resolves.
    Lateness,
    /// On a linear axis: a play of a small share of a stroke.
    DrivePlay,
    /// On a linear axis: a drive that gives by a small share of a stroke.
    DriveStiffness,
    /// On a linear axis: a drive that rings fast against a stroke.
    DriveInertia,
    /// On a linear axis: a drive that damps at a usual speed.
    DriveDamping,
}

impl Start {
    /// The name used in files and in Python.
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

/// What bounds a parameter from above in a fit, beside the catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Nothing.
    Catalogue,
    /// The fastest speed on record: it is the speed at which a film carries the load alone, and
    /// what lies far beyond the record never shows.
    TransitionSpeed,
}

impl Bound {
    /// The name used in files and in Python.
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
/// const B: Parameter = Parameter::new("b_n", "N", "reading without force", [-1e5, 1e5], &[0.3])
///     .null(0.0)
///     .signed();
/// assert_eq!((B.null, B.mirror, B.log), (Some(0.0), Mirror::Negate, false));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
    /// What a mirror does to it.
    pub mirror: Mirror,
    /// Where a fit of a law in newtons starts.
    pub start: Start,
    /// What bounds it from above in a fit.
    pub bound: Bound,
    /// True of a number that is stated, not found: a fit holds it where it starts, or where it is
    /// told to. It says in what terms the others are meant (a reference), or stands in a form with
    /// one parameter more than records tell.
    pub stated: bool,
}

impl Parameter {
    /// A parameter between two bounds without a null, walked in its own unit.
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

    /// A scale: a fit walks in its logarithm.
    pub const fn log(mut self) -> Self {
        self.log = true;
        self
    }

    /// The value at which the effect vanishes.
    pub const fn null(mut self, value: f64) -> Self {
        self.null = Some(value);
        self
    }

    /// An angle that wraps.
    pub const fn period(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// It knows left from right: a mirror changes its sign.
    pub const fn signed(mut self) -> Self {
        self.mirror = Mirror::Negate;
        self
    }

    /// What in the data it is about the size of.
    pub const fn start(mut self, start: Start) -> Self {
        self.start = start;
        self
    }

    /// A number that is stated, not found.
    pub const fn stated(mut self) -> Self {
        self.stated = true;
        self
    }

    /// What in the data bounds it.
    pub const fn bound(mut self, bound: Bound) -> Self {
        self.bound = bound;
        self
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
