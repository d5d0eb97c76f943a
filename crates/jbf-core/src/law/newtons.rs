//! Common parts of the laws in newtons: their load, and the check of a speed.
//!
//! The bounds of their parameters include machines of every size, from a watch to a press. The usual
//! values are those of a machine with about 10 N of friction; a fit estimates its start values from
//! the data.

use crate::error::{check, Error};

/// Checks that a speed is finite and not zero; at rest the friction is set-valued.
pub(super) fn moving(velocity_m_s: f64) -> Result<(), Error> {
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
