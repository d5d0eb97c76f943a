//! Dual numbers: a value and its derivatives with respect to `N` parameters at once.
//!
//! Forward mode suits this application: few parameters, long records. The `N` derivatives are one
//! array, which the compiler maps to vector lanes, so the cost per parameter falls as their number
//! rises.

use crate::real::Real;
use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use num_traits::{One, Zero};

/// A value with its derivatives with respect to `N` parameters.
#[derive(Clone, Copy, Debug)]
pub struct Dual<const N: usize> {
    /// Value of the number.
    pub value: f64,
    /// Derivatives of the value with respect to each parameter.
    pub slope: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// Creates the parameter number `index`: its derivative with respect to itself is one.
    ///
    /// An `index` of `N` or more creates a constant.
    pub fn parameter(value: f64, index: usize) -> Self {
        let mut slope = [0.0; N];
        if let Some(own) = slope.get_mut(index) {
            *own = 1.0;
        }
        Self { value, slope }
    }

    /// Returns `value` with the derivatives of `self` multiplied by `factor` (the chain rule).
    #[inline(always)]
    fn chain(self, value: f64, factor: f64) -> Self {
        let mut slope = self.slope;
        for s in &mut slope {
            *s *= factor;
        }
        Self { value, slope }
    }

    /// Returns `value` with the derivatives `a * self' + b * other'`.
    #[inline(always)]
    fn combine(self, other: Self, value: f64, a: f64, b: f64) -> Self {
        let mut slope = self.slope;
        for (s, o) in slope.iter_mut().zip(other.slope.iter()) {
            *s = a * *s + b * *o;
        }
        Self { value, slope }
    }
}

impl<const N: usize> PartialEq for Dual<N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let mut slope = self.slope;
        for (s, o) in slope.iter_mut().zip(other.slope.iter()) {
            *s += *o;
        }
        Self {
            value: self.value + other.value,
            slope,
        }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let mut slope = self.slope;
        for (s, o) in slope.iter_mut().zip(other.slope.iter()) {
            *s -= *o;
        }
        Self {
            value: self.value - other.value,
            slope,
        }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.combine(other, self.value * other.value, other.value, self.value)
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let inverse = 1.0 / other.value;
        // The quotient itself is divided, not multiplied by the inverse, so that the value has the
        // same bits as a plain f64 evaluation.
        let value = self.value / other.value;
        self.combine(other, value, inverse, -value * inverse)
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<const N: usize> MulAssign for Dual<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<const N: usize> DivAssign for Dual<N> {
    #[inline(always)]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<const N: usize> Zero for Dual<N> {
    #[inline(always)]
    fn zero() -> Self {
        Self::ZERO
    }
    /// Returns true if the value and all derivatives are zero.
    fn is_zero(&self) -> bool {
        self.value == 0.0 && self.slope == [0.0; N]
    }
}

impl<const N: usize> One for Dual<N> {
    #[inline(always)]
    fn one() -> Self {
        Self::ONE
    }
}

impl<const N: usize> crate::real::sealed::Sealed for Dual<N> {}

impl<const N: usize> Real for Dual<N> {
    const HAS_SLOPES: bool = true;
    const ZERO: Self = Self {
        value: 0.0,
        slope: [0.0; N],
    };
    const ONE: Self = Self {
        value: 1.0,
        slope: [0.0; N],
    };
    const EPS_LIMIT: Self = Self {
        value: <f64 as Real>::EPS_LIMIT,
        slope: [0.0; N],
    };

    #[inline(always)]
    fn of(value: f64) -> Self {
        Self {
            value,
            slope: [0.0; N],
        }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = crate::root::sqrt(self.value);
        // A square root at zero has no finite slope; a slope of zero lets an optimiser continue.
        let factor = if root > 0.0 { 0.5 / root } else { 0.0 };
        self.chain(root, factor)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = libm::exp(self.value);
        self.chain(value, value)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        let value = libm::expm1(self.value);
        self.chain(value, value + 1.0)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(libm::log(self.value), 1.0 / self.value)
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(libm::sin(self.value), libm::cos(self.value))
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(libm::cos(self.value), -libm::sin(self.value))
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        let value = libm::pow(self.value, exponent.value);
        if self.value <= 0.0 {
            return Self::of(value);
        }
        let by_base = exponent.value * value / self.value;
        let by_exponent = value * libm::log(self.value);
        self.combine(exponent, value, by_base, by_exponent)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 {
            -self
        } else {
            self
        }
    }
    #[inline(always)]
    fn implicit(value: f64, residual: Self, slope: f64) -> Self {
        residual.chain(value, -1.0 / slope)
    }
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self.chain(self.value * factor, factor)
    }
    #[inline(always)]
    fn joined<const K: usize>(value: f64, inputs: [(Self, f64); K]) -> Self {
        let mut sum = Self::of(value);
        for (input, partial) in inputs {
            for (s, i) in sum.slope.iter_mut().zip(input.slope.iter()) {
                *s += partial * *i;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivative of each operation equals a central difference of its evaluation in f64.
    #[test]
    fn derivatives_of_dual_numbers_match_central_differences() {
        fn f<T: Real>(x: T, y: T) -> T {
            (x * y).sin() / (y + T::of(2.0)).sqrt()
                + (x - y).abs().powf(y) * x.exp().ln() * (-y).exp_m1()
                - x.cos() * y
        }
        let (x, y) = (0.7, 1.3);
        let d = f(Dual::<2>::parameter(x, 0), Dual::<2>::parameter(y, 1));
        let h = 1e-6;
        let by_x = (f(x + h, y) - f(x - h, y)) / (2.0 * h);
        let by_y = (f(x, y + h) - f(x, y - h)) / (2.0 * h);
        assert_eq!(d.value, f(x, y));
        assert!((d.slope[0] - by_x).abs() < 1e-8, "{} {by_x}", d.slope[0]);
        assert!((d.slope[1] - by_y).abs() < 1e-8, "{} {by_y}", d.slope[1]);
    }
}
