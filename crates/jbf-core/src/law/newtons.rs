//! Common parts of the laws in newtons: descriptions of parameters, and the check of a speed.
//!
//! The bounds of the parameters include machines of every size, from a watch to a press. The start
//! values are those of a machine with about 10 N of friction; a fit estimates its start values from
//! the data.

use crate::error::{check, ParameterError};
use crate::page::{Parameter, Start};

/// Describes a positive force, N.
pub(super) const fn force(
    name: &'static str,
    meaning: &'static str,
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "N", meaning, [1e-6, 1e7], starts).log()
}

/// Describes a characteristic speed, whose logarithm is fitted, m/s.
pub(super) const fn speed(
    name: &'static str,
    meaning: &'static str,
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "m/s", meaning, [1e-7, 1e3], starts).log()
}

/// Describes a stiffness of the contact, N/m.
pub(super) const fn stiffness(
    name: &'static str,
    meaning: &'static str,
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "N/m", meaning, [1e-2, 1e12], starts)
        .log()
        .start(Start::Stiffness)
}

/// Describes a damping, which may be zero, N s/m.
pub(super) const fn damping(
    name: &'static str,
    meaning: &'static str,
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "N s/m", meaning, [0.0, 1e7], starts)
}

/// Describes a characteristic time, whose logarithm is fitted, s.
pub(super) const fn time(
    name: &'static str,
    meaning: &'static str,
    bounds: [f64; 2],
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "s", meaning, bounds, starts).log()
}

/// Describes a dimensionless number, whose logarithm is fitted.
pub(super) const fn number(
    name: &'static str,
    meaning: &'static str,
    bounds: [f64; 2],
    starts: &'static [f64],
) -> Parameter {
    Parameter::new(name, "-", meaning, bounds, starts).log()
}

/// Parameter `F_c`: Coulomb (kinetic) friction.
pub(super) const F_C: Parameter =
    force("F_c", "Coulomb (kinetic) friction", &[10.0]).start(Start::Kinetic);
/// Parameter `F_s`: static (breakaway) friction.
pub(super) const F_S: Parameter =
    force("F_s", "static (breakaway) friction", &[12.0]).start(Start::Breakaway);
/// Parameter `F_v`: viscous friction coefficient.
pub(super) const F_V: Parameter = damping("F_v", "viscous friction", &[10.0]).start(Start::Viscous);
/// Parameter `v_s`: Stribeck speed.
pub(super) const V_S: Parameter = speed(
    "v_s",
    "Stribeck speed: scale of the decrease of friction",
    &[0.01, 0.1],
)
.start(Start::StribeckSpeed);

/// Checks that a speed is finite and not zero; at rest the friction is set-valued.
pub(super) fn moving(velocity_m_s: f64) -> Result<(), ParameterError> {
    check(
        velocity_m_s.is_finite() && velocity_m_s != 0.0,
        "velocity_m_s",
        velocity_m_s,
        "must be finite and not zero",
    )
}

/// Defines the constants and methods of [`super::Law`] that are identical for all laws in newtons.
macro_rules! in_newtons {
    () => {
        /// Viscous friction has another cause (a seal, grease) and does not deflect, as in the laws
        /// of Dahl and LuGre.
        const BENDS_WHOLE: bool = false;

        /// Returns a load of one newton, because the coefficient of this law is a force.
        #[inline(always)]
        fn pressed_n(&self, _load_n: T) -> T {
            T::ONE
        }

        #[inline(always)]
        fn set_load(&self, _state: &mut Self::State, _load_n: T) {}
    };
}

pub(super) use in_newtons;
