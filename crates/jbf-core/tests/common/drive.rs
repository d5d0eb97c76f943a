//! Integrates a journal law along a given speed with any explicit method.

use jbf_core::law::journal::{Journal, State};
use jbf_core::stepper::Stepper;
use jbf_core::Real;

/// Advances `state` from `t0` to `t1` (s) in equal steps of at most `step_s`.
///
/// The speed |U| is exact at the start, the middle and the end of each step.
pub fn drive<T: Real, S: Stepper>(
    law: &Journal<T>,
    stepper: &S,
    state: &mut State<T>,
    [t0, t1]: [f64; 2],
    step_s: f64,
    speed_m_s: impl Fn(f64) -> f64,
) {
    let n = ((t1 - t0) / step_s - 1e-9).ceil().max(1.0);
    let h = (t1 - t0) / n;
    for i in 0..n as u32 {
        let t = t0 + h * f64::from(i);
        let at = [t, t + 0.5 * h, t + h].map(|t| T::of(speed_m_s(t).abs()));
        law.advance_with(stepper, state, at, T::ONE, T::of(h));
    }
}
