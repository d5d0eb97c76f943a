//! Vogel's relation between viscosity and temperature:
//!
//! ```text
//! mu(T) = mu(T_0) exp(B/(T - C) - B/(T_0 - C))
//! ```
//!
//! Source: Vogel (1921), Fulcher (1925), Tammann & Hesse (1926). B tells how steeply an oil thins, C
//! at which temperature it would set. For mineral oils of every grade C = -95 C serves (Crouch &
//! Cameron 1961), which leaves one parameter. Over 20 to 30 K a record does not tell C from B: a C that
//! is off by 15 K changes the viscosity by less than 2 % there once B is found with it. Walther's
//! relation (ASTM D341) has two parameters of an oil, too, and no reason to be preferred between 0 and
//! 100 C: the tests compare the two.

use crate::page::{Parameter, Start};
use crate::real::Real;

/// The C of mineral oils, C.
const OILS_C: f64 = -95.0;
/// So close to C, K, the relation is followed: oil sets long before.
const NEAREST_K: f64 = 20.0;
/// The natural logarithm of the viscosity is held within so much of its reference: beyond, no oil
/// runs any more in the same bearing.
const FURTHEST: f64 = 7.0;

/// The page of a reference temperature.
pub(super) const REFERENCE: Parameter = Parameter::new(
    "T_0_c",
    "C",
    "reference temperature: the law's parameters hold at it",
    [-100.0, 1000.0],
    &[40.0],
)
.start(Start::ReferenceTemperature)
.stated();

/// The page of Vogel's C.
pub(super) const C: Parameter = Parameter::new(
    "C_c",
    "C",
    "Vogel's C: of mineral oils -95",
    [-250.0, -60.0],
    &[OILS_C],
)
.stated();

/// The relation with its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vogel<T> {
    /// B, K.
    pub b_k: T,
    /// C, C.
    pub c_c: T,
    /// Temperature at which the viscosity is the law's, C.
    pub reference_c: T,
}

impl<T: Real> Vogel<T> {
    /// Viscosity over that at the reference temperature; one without a temperature.
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
