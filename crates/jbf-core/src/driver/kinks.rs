//! Location of kinks: roots of a function between two points where its sign differs.

use crate::real::Real;

/// Evaluates a polynomial of degree four, with coefficients `c` from the constant upwards, at `s`.
#[inline]
pub(super) fn polynomial<T: Real>(c: &[T; 5], s: T) -> T {
    c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * c[4])))
}

/// Eccentricity ratio at the fraction `s` of a step, from polynomials of the position.
pub(super) fn eps_along<T: Real>(along: &[[T; 5]; 2], s: f64) -> f64 {
    let (x, y) = (
        polynomial(&along[0], T::of(s)).value(),
        polynomial(&along[1], T::of(s)).value(),
    );
    crate::root::sqrt(x * x + y * y)
}

/// Finds a root between `low` and `high`, where the signs of `f` differ, with an accuracy of
/// `within`.
pub(super) fn root(mut low: f64, mut high: f64, within: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut f_low, mut f_high) = (f(low), f(high));
    for round in 0..100 {
        if f_low == 0.0 || high - low <= within {
            return low;
        }
        if f_high == 0.0 {
            return high;
        }
        let guess = low + (high - low) * (f_low / (f_low - f_high));
        let inside = guess > low && guess < high && round < 60;
        let mid = if inside { guess } else { 0.5 * (low + high) };
        let f_mid = f(mid);
        if (f_mid < 0.0) == (f_low < 0.0) {
            (low, f_low) = (mid, f_mid);
            f_high *= 0.5;
        } else {
            (high, f_high) = (mid, f_mid);
            f_low *= 0.5;
        }
        // False position converges from one side, so the residual at the last point measures the
        // distance.
        if libm::fabs(f_mid) <= 1e-15 {
            return mid;
        }
    }
    0.5 * (low + high)
}
