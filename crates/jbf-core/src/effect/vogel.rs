//! Vogel relation between viscosity and temperature:
//!
//! ```text
//! mu(T) = mu(T_0) exp(B/(T - C) - B/(T_0 - C))
//! ```
//!
//! Source: Vogel (1921), Fulcher (1925), Tammann & Hesse (1926). B determines how steeply the
//! viscosity falls, C the temperature at which the oil would solidify. C = -95 C is valid for
//! mineral oils of every grade (Crouch & Cameron 1961), which leaves one parameter.
//!
//! Over 20 to 30 K a record cannot distinguish C from B. An error of C by 15 K changes the
//! viscosity by less than 2 % there, once B is fitted with it. Walther's relation (ASTM D341) also
//! has two parameters and is not better between 0 and 100 C: the tests compare the two.

use crate::page::{Parameter, Start};
use crate::real::Real;

/// Vogel's C of mineral oils, C.
const OILS_C: f64 = -95.0;
/// Smallest distance from C, K, at which the relation is evaluated; oil solidifies long before.
const NEAREST_K: f64 = 20.0;
/// Largest deviation of the natural logarithm of the viscosity from its reference. Beyond it no oil
/// runs in the same bearing.
const FURTHEST: f64 = 7.0;

/// Description of a reference temperature.
pub(super) const REFERENCE: Parameter = Parameter::new(
    "T_0_c",
    "C",
    "reference temperature, at which the law's parameters hold",
    [-100.0, 1000.0],
    &[40.0],
)
.start(Start::ReferenceTemperature)
.stated();

/// Description of Vogel's C.
pub(super) const C: Parameter = Parameter::new(
    "C_c",
    "C",
    "Vogel's C: -95 for mineral oils",
    [-250.0, -60.0],
    &[OILS_C],
)
.stated();

/// The relation with its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vogel<T> {
    /// Vogel's B, K.
    pub b_k: T,
    /// Vogel's C, C.
    pub c_c: T,
    /// Temperature at which the viscosity is that of the law, C.
    pub reference_c: T,
}

impl<T: Real> Vogel<T> {
    /// Viscosity relative to that at the reference temperature; one without a temperature.
    #[inline(always)]
    pub(super) fn factor(&self, temperature_c: Option<T>) -> T {
        let Some(temperature_c) = temperature_c else {
            return T::ONE;
        };
        let inverse = |c: T| T::ONE / (c - self.c_c).max(T::of(NEAREST_K));
        let log = self.b_k * (inverse(temperature_c) - inverse(self.reference_c));
        log.max(T::of(-FURTHEST)).min(T::of(FURTHEST)).exp()
    }
}
