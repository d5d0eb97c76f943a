//! Vogel relation between viscosity and temperature:
//!
//! ```text
//! mu(T) = mu(T_0) exp(B/(T - C) - B/(T_0 - C))
//! ```
//!
//! Source: Vogel (1921), Fulcher (1925), Tammann & Hesse (1926). B determines how steeply the
//! viscosity falls with temperature, and C is the temperature at which the viscosity would become
//! infinite. C = -95 C is valid for mineral oils of every grade (Crouch & Cameron 1961), so only B
//! is fitted.
//!
//! Over 20 to 30 K a record cannot distinguish C from B. With B fitted, an error of 15 K in C
//! changes the viscosity by less than 2 % in such a range. Walther's relation (ASTM D341) also has
//! two parameters and is not better between 0 and 100 C: the tests compare the two.

use crate::real::Real;

/// Smallest distance from C at which the relation is evaluated, K; oil solidifies at a much larger
/// distance.
const NEAREST_K: f64 = 20.0;
/// Limit of the natural logarithm of the relative viscosity; a larger change is outside the range
/// of any oil in a bearing.
const FURTHEST: f64 = 7.0;

/// Vogel relation with its constants and the reference temperature.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vogel<T> {
    /// Vogel's constant B, K.
    pub b_k: T,
    /// Vogel's constant C, C.
    pub c_c: T,
    /// Reference temperature, at which the viscosity is that of the law, C.
    pub reference_c: T,
}

impl<T: Real> Vogel<T> {
    /// Viscosity relative to that at the reference temperature; one if no temperature was recorded.
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
