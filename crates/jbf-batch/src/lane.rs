//! Scalar type for one lane of a vector register: a number with a square root that the compiler can
//! vectorise.
//!
//! IEEE 754 requires that square roots are rounded correctly, so `std` and `libm` return the same
//! bits. The square root of `libm` is assembly code for one number at a time.

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use jbf_core::Real;
use num_traits::{One, Zero};

/// Number in one lane of a vector register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Lane<F>(pub F);

/// Number types that a lane can hold.
pub trait Float: Real + Send + Sync + Default {
    /// Returns the square root, computed by `std`.
    fn root(self) -> Self;
}

impl Float for f32 {
    #[inline(always)]
    fn root(self) -> Self {
        f32::sqrt(self)
    }
}

impl Float for f64 {
    #[inline(always)]
    fn root(self) -> Self {
        f64::sqrt(self)
    }
}

impl<F: Float> PartialOrd for Lane<F> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        self.0 < other.0
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.0 <= other.0
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        self.0 > other.0
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        self.0 >= other.0
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident $sign:tt),*) => {$(
        impl<F: Float> $trait for Lane<F> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $sign other.0)
            }
        }
    )*};
}

operator!(Add add +, Sub sub -, Mul mul *, Div div /);

macro_rules! assigning {
    ($($trait:ident $method:ident $sign:tt),*) => {$(
        impl<F: Float> $trait for Lane<F> {
            #[inline(always)]
            fn $method(&mut self, other: Self) {
                *self = *self $sign other;
            }
        }
    )*};
}

assigning!(AddAssign add_assign +, SubAssign sub_assign -, MulAssign mul_assign *, DivAssign div_assign /);

impl<F: Float> Neg for Lane<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl<F: Float> Zero for Lane<F> {
    #[inline(always)]
    fn zero() -> Self {
        Self(F::ZERO)
    }
    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }
}

impl<F: Float> One for Lane<F> {
    #[inline(always)]
    fn one() -> Self {
        Self(F::ONE)
    }
}

macro_rules! through {
    ($($name:ident),*) => {$(
        #[inline(always)]
        fn $name(self) -> Self {
            Self(self.0.$name())
        }
    )*};
}

impl<F: Float> jbf_core::internals::Sealed for Lane<F> {}

impl<F: Float> Real for Lane<F> {
    const ZERO: Self = Self(F::ZERO);
    const ONE: Self = Self(F::ONE);
    const EPS_LIMIT: Self = Self(F::EPS_LIMIT);
    const SIDE_BY_SIDE: bool = true;

    through!(exp, exp_m1, ln, sin, cos, abs);

    #[inline(always)]
    fn of(value: f64) -> Self {
        Self(F::of(value))
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.0.value()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.root())
    }
    #[inline(always)]
    fn powf(self, exponent: Self) -> Self {
        Self(self.0.powf(exponent.0))
    }
    #[inline(always)]
    fn implicit(value: f64, residual: Self, slope: f64) -> Self {
        Self(F::implicit(value, residual.0, slope))
    }
}
