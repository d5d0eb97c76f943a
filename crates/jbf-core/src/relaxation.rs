//! Exact solution of the first-order relaxation `y' = (x - y) / tau` for a linear input.
//!
//! Low-pass filters, the temperature of a film and bristles use this solution, which is stable for
//! any step.

use crate::real::Real;

/// Returns `y` after a step of `ratio = dt / tau` in which the input changes linearly from `x[0]`
/// to `x[1]`.
///
/// For short steps, the increment of `y` is computed; for long steps, the distance from `x[1]`.
/// Each formula would suffer from cancellation in the other case: in single precision, a
/// temperature rise that is never negative would become negative.
#[inline(always)]
pub(crate) fn relax<T: Real>(y: T, x: [T; 2], ratio: T) -> T {
    let gain = -(-ratio).exp_m1();
    if ratio.value() < 1.0 {
        y + (x[0] - y) * gain + (x[1] - x[0]) * lead(ratio, gain)
    } else {
        x[1] - (x[1] - x[0]) * (gain / ratio) + (y - x[0]) * (T::ONE - gain)
    }
}

/// Computes `1 - gain / ratio`, by its series if the difference would suffer from cancellation.
#[inline(always)]
fn lead<T: Real>(ratio: T, gain: T) -> T {
    if ratio.value() < 1e-3 {
        ratio * (T::of(0.5) - ratio * (T::of(1.0 / 6.0) - ratio * T::of(1.0 / 24.0)))
    } else {
        T::ONE - gain / ratio
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relaxation_of_a_ramp_follows_its_closed_form() {
        // y' = (t - y)/tau from y(0) = 0: y = t - tau (1 - exp(-t/tau)).
        for tau in [0.3_f64, 0.01, 30.0] {
            let dt = 0.05;
            let mut y = 0.0;
            for i in 0..40 {
                let t = f64::from(i) * dt;
                y = relax(y, [t, t + dt], dt / tau);
            }
            let t = 2.0_f64;
            assert!(
                (y - (t + tau * libm::expm1(-t / tau))).abs() < 1e-13,
                "{tau}"
            );
        }
    }

    #[test]
    fn relaxation_is_continuous_between_its_approximations() {
        let at = |r: f64| relax(0.3, [1.0, 2.0], r);
        for joint in [1e-3, 1.0] {
            let (below, above) = (at(joint * (1.0 - 1e-12)), at(joint * (1.0 + 1e-12)));
            assert!((below - above).abs() < 1e-11, "{joint}: {below} {above}");
        }
    }

    #[test]
    fn relaxation_settles_for_an_infinite_step() {
        assert_eq!(relax(5.0_f64, [1.0, 1.0], f64::INFINITY), 1.0);
        assert!(relax(5.0_f32, [1.0, 1.0], 1e30).is_finite());
    }

    /// The result for non-negative inputs is not negative, including rounding.
    #[test]
    fn relaxation_of_non_negative_inputs_is_not_negative() {
        for power in -80..20 {
            let ratio = libm::powf(10.0, 0.1 * power as f32);
            for x in [[1e12_f32, 1e12], [1e12, 0.0], [0.0, 1e12], [1e-12, 1e-12]] {
                for y in [0.0_f32, 1e-10, 1.0, 1e12] {
                    assert!(relax(y, x, ratio) >= 0.0, "{y} {x:?} {ratio}");
                }
            }
        }
    }
}
