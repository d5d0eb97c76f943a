//! Description of one parameter of a law or an effect.
//!
//! The description is the single source of the name, the bounds, the start values of a fit, and the
//! behaviour under reflection.

use crate::error::{check, given, needed, within, ParameterError};
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
/// value.
///
/// The function can check constants at compile time.
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

/// Returns true if two names are equal apart from the case of letters; usable at compile time.
pub(crate) const fn same(a: &str, b: &str) -> bool {
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
/// Reports the first value that is missing or out of bounds.
pub(crate) fn in_bounds<T: Real>(pages: &[Parameter], values: &[T]) -> Result<(), ParameterError> {
    for (i, p) in pages.iter().enumerate() {
        let value = given(values, i, p.name)?.value();
        if p.null != Some(value) {
            within(p.name, value, [p.lower, p.upper])?;
        }
    }
    Ok(())
}

/// Returns the values that `Parameters::default()` of a law or an effect has.
///
/// A parameter has the value without effect where there is a finite one, and otherwise the first
/// start value of a fit.
pub(crate) fn defaults<const N: usize>(pages: &[Parameter; N]) -> [f64; N] {
    pages.each_ref().map(|page| match page.null {
        Some(null) if null.is_finite() => null,
        _ => page.starts[0],
    })
}

/// Returns as many values as there are parameters, each checked against its bounds.
///
/// # Errors
/// Reports the first value that is missing, out of its bounds, or infinite where the effect
/// vanishes: the effect must be omitted in this case.
pub(crate) fn checked<T: Real, const N: usize>(
    pages: &[Parameter; N],
    values: &[T],
) -> Result<[T; N], ParameterError> {
    for (page, value) in pages.iter().zip(values) {
        let infinite = page.null.is_some_and(|null| !null.is_finite());
        check(
            !infinite || page.null != Some(value.value()),
            page.name,
            value.value(),
            "is the value at which the effect vanishes: omit the effect",
        )?;
    }
    in_bounds(pages, values)?;
    let values = values.first_chunk();
    needed("parameters", values.copied())
}

/// Describes a law or an effect for the catalogue, together with its parameters.
///
/// The macro is the only place in which the names, units, meanings and bounds of the parameters are
/// written. From them it generates the struct `Parameters` with its documentation and default, the
/// constant `PARAMETERS`, and the constructor `new`. The first word is the macro that implements the
/// trait of the catalogue, `named_law` or `named_effect`.
///
/// The type needs a method `with_parameters(Parameters<T>) -> Self`, which receives checked values.
///
/// ```ignore
/// described! {
///     named_effect CoulombDrag = Info::new("coulomb_drag", Stage::Other).summary("...");
///     f_d = "F_d", "N", "drag force per bearing", [0.0, 1e4], [0.5] null(0.0) .start(Start::Drag);
/// }
/// ```
///
/// Each line has the field, the name in files, the unit, the meaning, the bounds, the start values
/// of a fit, the value without effect if there is one, and calls of the methods of [`Parameter`].
/// The field is the name in files in lower case, which is checked at compile time. Parameters that
/// several laws or effects have in common, such as `F_c;`, are written as their name.
macro_rules! described {
    // Parameters in common, replaced by their full lines.
    (@ $O:tt $i:tt [$($d:tt)*] F_c; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        f_c = "F_c", "N", "Coulomb (kinetic) friction", [1e-6, 1e7], [10.0]
            .log().start($crate::page::Start::Kinetic);
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] F_s; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        f_s = "F_s", "N", "static (breakaway) friction", [1e-6, 1e7], [12.0]
            .log().start($crate::page::Start::Breakaway);
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] F_v; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        f_v = "F_v", "N s/m", "viscous friction", [0.0, 1e7], [10.0]
            .start($crate::page::Start::Viscous);
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] v_s; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        v_s = "v_s", "m/s", "Stribeck speed: scale of the decrease of friction", [1e-7, 1e3],
            [0.01, 0.1] .log().start($crate::page::Start::StribeckSpeed);
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] phase_rad; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        phase_rad = "phase_rad", "rad", "phase at position zero", [-4.0 * PI, 4.0 * PI],
            [0.0, FRAC_PI_2, PI, -FRAC_PI_2] .period(TAU).signed();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] C_c; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        c_c = "C_c", "C", "Vogel's C: -95 for mineral oils", [-250.0, -60.0], [-95.0] .stated();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] T_0_c; $($r:tt)*) => { $crate::page::described! { @ $O $i [$($d)*
        t_0_c = "T_0_c", "C", "reference temperature, at which the law's parameters hold",
            [-100.0, 1000.0], [40.0]
            .start($crate::page::Start::ReferenceTemperature).stated();
    ] $($r)* } };
    // A full line is kept.
    (@ $O:tt $i:tt [$($d:tt)*]
        $field:ident = $name:literal, $unit:literal, $meaning:literal, $bounds:tt, $starts:tt
            $(null $null:tt)? $(.$method:ident $argument:tt)*; $($r:tt)*
    ) => { $crate::page::described! { @ $O $i [$($d)*
        $field = $name, $unit, $meaning, $bounds, $starts $(null $null)? $(.$method $argument)*;
    ] $($r)* } };

    // All lines are complete.
    (@ [$kind:ident $Owner:ident] $info:tt [$(
        $field:ident = $name:literal, $unit:literal, $meaning:literal, [$lower:expr, $upper:expr],
            [$($start:expr),+] $(null($null:expr))? $(.$method:ident($($argument:tt)*))*;
    )*]) => {
        #[doc = concat!("Parameters of [`", stringify!($Owner), "`].")]
        ///
        /// The default of a parameter is the value without effect, or otherwise its usual value.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Parameters<T> {
            $(
                #[doc = concat!(
                    "`", $name, "`, ", $unit, ": ", $meaning, ".\n\nFrom ", stringify!($lower),
                    " to ", stringify!($upper), $("; no effect at ", stringify!($null),)?
                    "; usual values ", stringify!($($start),+), "."
                )]
                pub $field: T,
            )*
        }

        /// Descriptions of the parameters, in the order of their values.
        pub(crate) const PARAMETERS: &[$crate::page::Parameter; [$($name),*].len()] = &[$({
            assert!(
                $crate::page::same($name, stringify!($field)),
                "the field of a parameter is its name in lower case"
            );
            $crate::page::Parameter::new($name, $unit, $meaning, [$lower, $upper], &[$($start),+])
                $(.null($null))? $(.$method($($argument)*))*
        }),*];

        // The journal laws have checks of their own.
        #[allow(dead_code)]
        impl<T: $crate::real::Real> Parameters<T> {
            /// Creates the parameters from their values in the order of the catalogue.
            pub(crate) fn of(values: &[T]) -> Result<Self, $crate::error::ParameterError> {
                let [$($field),*] = $crate::page::checked(PARAMETERS, values)?;
                Ok(Self { $($field),* })
            }

            /// Returns the parameters if every one is within its bounds.
            pub(crate) fn checked(self) -> Result<Self, $crate::error::ParameterError> {
                Self::of(&[$(self.$field),*])
            }

            /// Converts to another number type, without derivatives.
            #[must_use]
            pub fn cast<U: $crate::real::Real>(&self) -> Parameters<U> {
                Parameters { $($field: U::of(self.$field.value())),* }
            }
        }

        impl Parameters<f64> {
            /// Returns true if every parameter is within its bounds or at its value without effect;
            /// can check constants at compile time.
            #[must_use]
            pub const fn is_valid(&self) -> bool {
                $crate::page::values_fit(PARAMETERS, &[$(self.$field),*])
            }
        }

        impl<T: $crate::real::Real> Default for Parameters<T> {
            fn default() -> Self {
                let [$($field),*] = $crate::page::defaults(PARAMETERS);
                Self { $($field: T::of($field)),* }
            }
        }

        $crate::page::described! { @named $kind $Owner $info }
    };

    (@named parameters $Owner:ident ()) => {};
    (@named $named:ident $Owner:ident ($info:expr)) => {
        $named! { $Owner $info }

        impl<T: $crate::real::Real> $Owner<T> {
            /// Creates the model from its parameters.
            ///
            /// # Errors
            /// Reports the first parameter that is out of its bounds.
            pub fn new(parameters: Parameters<T>) -> Result<Self, $crate::error::ParameterError> {
                parameters.checked().map(Self::with_parameters)
            }
        }
    };

    (parameters $Owner:ident; $($lines:tt)*) => {
        $crate::page::described! { @ [parameters $Owner] () [] $($lines)* }
    };
    // Same parameters as another module of which this one is a second instance.
    ($named:ident $Owner:ident = $info:expr; as $($part:ident)::+;) => {
        pub use $($part::)+Parameters;
        use $($part::)+PARAMETERS;

        $crate::page::described! { @named $named $Owner ($info) }
    };
    ($kind:ident $Owner:ident = $info:expr; $($lines:tt)*) => {
        $crate::page::described! { @ [$kind $Owner] ($info) [] $($lines)* }
    };
}

pub(crate) use described;
