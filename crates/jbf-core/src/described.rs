//! Macro that generates the parameters of a law or an effect and its entry in the catalogue.

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
///     f_d = "F_d", "N", "drag force per bearing", [0.0, 1e4], [0.5] null(0.0);
/// }
/// ```
///
/// Each line has the field, the name in files, the unit, the meaning, the bounds, the start values
/// of a fit, the value without effect if there is one, and calls of the methods of [`Parameter`].
/// The field is the name in files in lower case, which is checked at compile time. Parameters that
/// several laws or effects have in common, such as `F_c;`, are written as their name.
macro_rules! described {
    // The arms with `@` complete the lines one after the other. Their arguments are the kind and
    // the type `[kind Owner]` (`$O`), the description of the law or effect (`$i`), the complete
    // lines `[lines]` (`$d`), and the remaining lines (`$r`); each step moves one line from the
    // remaining to the complete lines.

    // Parameters in common, replaced by their full lines.
    (@ $O:tt $i:tt [$($d:tt)*] F_c; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        f_c = "F_c", "N", "Coulomb (kinetic) friction", [1e-6, 1e7], [10.0]
            .log();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] F_s; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        f_s = "F_s", "N", "static (breakaway) friction", [1e-6, 1e7], [12.0]
            .log();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] F_v; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        f_v = "F_v", "N s/m", "viscous friction", [0.0, 1e7], [10.0];
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] v_s; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        v_s = "v_s", "m/s", "Stribeck speed: scale of the decrease of friction", [1e-7, 1e3],
            [0.01, 0.1] .log();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] phase_rad; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        phase_rad = "phase_rad", "rad", "phase at position zero", [-4.0 * PI, 4.0 * PI],
            [0.0, FRAC_PI_2, PI, -FRAC_PI_2] .period(TAU).signed();
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] C_c; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        c_c = "C_c", "C", "Vogel's C: -95 for mineral oils", [-250.0, -60.0], [-95.0];
    ] $($r)* } };
    (@ $O:tt $i:tt [$($d:tt)*] T_0_c; $($r:tt)*) => { $crate::described::described! { @ $O $i [$($d)*
        t_0_c = "T_0_c", "C", "reference temperature, at which the law's parameters hold",
            [-100.0, 1000.0], [40.0];
    ] $($r)* } };
    // A full line is kept.
    (@ $O:tt $i:tt [$($d:tt)*]
        $field:ident = $name:literal, $unit:literal, $meaning:literal, $bounds:tt, $starts:tt
            $(null $null:tt)? $(.$method:ident $argument:tt)*; $($r:tt)*
    ) => { $crate::described::described! { @ $O $i [$($d)*
        $field = $name, $unit, $meaning, $bounds, $starts $(null $null)? $(.$method $argument)*;
    ] $($r)* } };

    // All lines are complete.
    (@ [$kind:ident $Owner:ident] $info:tt [$(
        $field:ident = $name:literal, $unit:literal, $meaning:literal, [$lower:expr, $upper:expr],
            [$($start:expr),+] $(null($null:expr))? $(.$method:ident($($argument:tt)*))*;
    )*]) => {
        #[doc = concat!("Parameters of [`", stringify!($Owner), "`].")]
        ///
        /// The default of a parameter is its finite value without effect, or otherwise the first of its
        /// usual values.
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
        pub(crate) const PARAMETERS: &[$crate::parameter::Parameter; [$($name),*].len()] = &[$({
            assert!(
                $crate::parameter::equal_ignoring_case($name, stringify!($field)),
                "the field of a parameter is its name in lower case"
            );
            $crate::parameter::Parameter::new($name, $unit, $meaning, [$lower, $upper], &[$($start),+])
                $(.null($null))? $(.$method($($argument)*))*
        }),*];

        // The journal laws have checks of their own.
        #[allow(dead_code)]
        impl<T: $crate::real::Real> Parameters<T> {
            /// Creates the parameters from their values in the order of the catalogue.
            pub(crate) fn of(values: &[T]) -> Result<Self, $crate::error::Error> {
                let [$($field),*] = $crate::parameter::checked(PARAMETERS, values)?;
                Ok(Self { $($field),* })
            }

            /// Returns the parameters if every one is within its bounds.
            pub(crate) fn checked(self) -> Result<Self, $crate::error::Error> {
                Self::of(&[$(self.$field),*])
            }

            /// Converts to another number type, without derivatives.
            #[must_use]
            pub fn cast<U: $crate::real::Real>(&self) -> Parameters<U> {
                Parameters { $($field: U::of(self.$field.value())),* }
            }
        }

        impl Parameters<f64> {
            /// Returns true if every parameter is within its bounds, or at its value without effect
            /// if this is finite; can check constants at compile time.
            #[must_use]
            pub const fn is_valid(&self) -> bool {
                $crate::parameter::values_fit(PARAMETERS, &[$(self.$field),*])
            }
        }

        impl<T: $crate::real::Real> Default for Parameters<T> {
            fn default() -> Self {
                let [$($field),*] = $crate::parameter::defaults(PARAMETERS);
                Self { $($field: T::of($field)),* }
            }
        }

        $crate::described::described! { @named $kind $Owner $info }
    };

    (@named parameters $Owner:ident ()) => {};
    (@named $named:ident $Owner:ident ($info:expr)) => {
        $named! { $Owner $info }

        impl<T: $crate::real::Real> $Owner<T> {
            /// Creates the model from its parameters.
            ///
            /// # Errors
            /// Reports the first parameter that is out of its bounds.
            pub fn new(parameters: Parameters<T>) -> Result<Self, $crate::error::Error> {
                parameters.checked().map(Self::with_parameters)
            }
        }
    };

    (parameters $Owner:ident; $($lines:tt)*) => {
        $crate::described::described! { @ [parameters $Owner] () [] $($lines)* }
    };
    // Same parameters as another module of which this one is a second instance.
    ($named:ident $Owner:ident = $info:expr; as $($part:ident)::+;) => {
        pub use $($part::)+Parameters;
        use $($part::)+PARAMETERS;

        $crate::described::described! { @named $named $Owner ($info) }
    };
    ($kind:ident $Owner:ident = $info:expr; $($lines:tt)*) => {
        $crate::described::described! { @ [$kind $Owner] ($info) [] $($lines)* }
    };
}

pub(crate) use described;
