//! Scalar type of the physics: `f32`, `f64`, or a [`crate::Dual`] that carries derivatives along
//! with the value.
//!
//! Every function uses `libm`, never the mathematical library of the platform, so that the same
//! input gives the same bits on a laptop and on a microcontroller.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use num_traits::{One, Zero};

/// Prevents other crates from implementing [`Real`], so that an additional operation does not break
/// their code.
pub(crate) mod sealed {
    /// Marks the types that may implement a sealed trait.
    pub trait Sealed {}
}

/// Real number type with which the models can be evaluated.
///
/// The trait is sealed: `f32`, `f64`, [`crate::Dual`], and the lanes of `jbf-batch` implement it.
/// Vectors and matrices of nalgebra may hold any of these types; sums, products and quotients with
/// a number are then available, decompositions only for `f32` and `f64`.
///
/// Comparisons use the value alone; a derivative never decides a branch.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + PartialEq
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
    + Zero
    + One
    + Send
    + Sync
    + 'static
{
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Largest eccentricity ratio that a state may hold: `1 - eps^2` must stay well above the
    /// rounding error of one.
    const EPS_LIMIT: Self;
    /// True for a type that represents one lane of a vector register.
    ///
    /// Lanes must not branch differently. A step that leaves the bearing is only marked, and its
    /// state is invalid; the caller must repeat the step in a scalar type.
    const SIDE_BY_SIDE: bool = false;
    /// True for a type that carries derivatives.
    ///
    /// A function of many operations and few inputs then computes its partial derivatives with
    /// respect to the inputs, and combines them once with [`Real::joined`]. Otherwise every
    /// operation would carry all derivatives.
    const HAS_SLOPES: bool = false;

    /// Converts a value to the nearest number of this type, with zero derivatives.
    fn of(value: f64) -> Self;
    /// Returns the value without derivatives.
    fn value(self) -> f64;
    /// Converts a whole number, without double precision on a target that lacks it.
    #[inline]
    fn from_i32(value: i32) -> Self {
        Self::of(f64::from(value))
    }
    /// Returns the largest whole number not above the value, limited to the range of `i32`.
    #[inline]
    fn floor_i32(self) -> i32 {
        libm::floor(self.value()) as i32
    }
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Computes `exp(self) - 1`, also accurately for small `self`.
    fn exp_m1(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Raises `self` to the power `exponent`, for a positive base.
    fn powf(self, exponent: Self) -> Self;
    /// Absolute value; the derivative at zero is that of `+self`.
    fn abs(self) -> Self;

    /// Returns the root `value` of `residual(x) = 0` with derivatives by the implicit function
    /// theorem.
    ///
    /// `residual` is evaluated at the root; `slope` is its derivative with respect to the unknown.
    fn implicit(value: f64, residual: Self, slope: f64) -> Self;

    /// Multiplies by a number without derivatives.
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self * Self::of(factor)
    }

    /// Returns `value` with derivatives by the chain rule, from inputs and the partial derivatives
    /// with respect to them.
    #[inline(always)]
    fn joined<const K: usize>(value: f64, inputs: [(Self, f64); K]) -> Self {
        let _ = inputs;
        Self::of(value)
    }

    /// Larger of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other {
            self
        } else {
            other
        }
    }

    /// Smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other {
            self
        } else {
            other
        }
    }

    /// Sign of the value, -1, 0 or +1, without derivative.
    #[inline(always)]
    fn sign(self) -> Self {
        if self > Self::ZERO {
            Self::ONE
        } else if self < Self::ZERO {
            -Self::ONE
        } else {
            Self::ZERO
        }
    }

    /// Returns true if the value is finite.
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.value().is_finite()
    }
}

macro_rules! real {
    (
        $t:ty, $limit:expr, $sqrt:path, $exp:path, $exp_m1:path, $ln:path, $sin:path, $cos:path, $pow:path,
        $abs:path
    ) => {
        impl sealed::Sealed for $t {}

        impl Real for $t {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const EPS_LIMIT: Self = $limit;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn value(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn from_i32(value: i32) -> Self {
                value as $t
            }
            #[inline(always)]
            fn floor_i32(self) -> i32 {
                let whole = self as i32;
                whole.saturating_sub(i32::from((whole as $t) > self))
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                <$t>::is_finite(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn exp_m1(self) -> Self {
                $exp_m1(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline(always)]
            fn cos(self) -> Self {
                $cos(self)
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                $pow(self, exponent)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $abs(self)
            }
            #[inline(always)]
            fn implicit(value: f64, _residual: Self, _slope: f64) -> Self {
                value as $t
            }
        }
    };
}

real!(
    f32,
    1.0 - 1e-6,
    crate::root::sqrtf,
    libm::expf,
    libm::expm1f,
    libm::logf,
    libm::sinf,
    libm::cosf,
    libm::powf,
    libm::fabsf
);
real!(
    f64,
    1.0 - 1e-9,
    crate::root::sqrt,
    libm::exp,
    libm::expm1,
    libm::log,
    libm::sin,
    libm::cos,
    libm::pow,
    libm::fabs
);
