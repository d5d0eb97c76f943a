//! Pure time delay of a signal, with a derivative with respect to the delay.
//!
//! The signal is stored at a fixed number of points over the delay and is interpolated linearly
//! between them.
//!

use crate::real::Real;

/// Number of points in the delay line.
///
/// Each step longer than `delay / (POINTS - 4)` is a point. Shorter steps share a point, so that
/// the line always covers the whole delay.
pub(crate) const POINTS: usize = 64;

/// Delay line for steps of any length and any delay.
///
/// The signal before the first point is taken as constant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DelayLine<T> {
    value: [T; POINTS],
    /// Time since the previous point, s.
    gap_s: [T; POINTS],
    newest: usize,
    filled: usize,
}

impl<T: Real> DelayLine<T> {
    pub(crate) fn new() -> Self {
        Self {
            value: [T::ZERO; POINTS],
            gap_s: [T::ZERO; POINTS],
            newest: 0,
            filled: 0,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.filled == 0
    }

    /// Appends the value of the signal `dt_s` after the last point, and keeps the points of the
    /// last `delay_s`.
    #[inline(always)]
    pub(crate) fn push(&mut self, value: T, dt_s: T, delay_s: T) {
        let spacing = delay_s / T::of((POINTS - 4) as f64);
        // The remainder does not change the index; it shows the compiler that no index is out of
        // bounds.
        let newest = self.newest % POINTS;
        // The newest point holds the present value; it moves on until it is far enough from the
        // previous point.
        if self.filled > 1 && self.gap_s[newest] < spacing {
            self.value[newest] = value;
            self.gap_s[newest] += dt_s;
            return;
        }
        let next = if self.filled > 0 {
            (newest + 1) % POINTS
        } else {
            newest
        };
        self.newest = next;
        self.filled = (self.filled + 1).min(POINTS);
        self.value[next] = value;
        self.gap_s[next] = dt_s;
    }

    /// Returns the signal `delay_s` ago; zero for an empty line.
    #[inline(always)]
    pub(crate) fn back(&self, delay_s: T) -> T {
        let mut age = T::ZERO;
        let mut at = self.newest % POINTS;
        for _ in 1..self.filled {
            let before = (at + POINTS - 1) % POINTS;
            let gap = self.gap_s[at];
            if age + gap > delay_s {
                let share = (delay_s - age) / gap;
                return self.value[at] + (self.value[before] - self.value[at]) * share;
            }
            age += gap;
            at = before;
        }
        self.value[at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// A delayed ramp is exact for steps that are short or long relative to the delay.
    #[test]
    fn delayed_ramp_lags_by_the_delay_for_any_step() {
        let delay = 0.0173_f64;
        for dt in [1e-5, 1e-4, 2e-3, 0.01, 0.05] {
            let mut line = DelayLine::new();
            let n = (0.5 / dt) as u32;
            line.push(0.0, 0.0, delay);
            for i in 1..=n {
                let t = f64::from(i) * dt;
                line.push(3.0 * t, dt, delay);
                let late = 3.0 * (t - delay).max(0.0);
                // Points that share a slot round the corner at the start.
                let exact = t > 2.0 * delay || dt > delay / 30.0;
                let error = (line.back(delay) - late).abs();
                assert!(
                    error < if exact { 1e-12 } else { 3.0 * delay / 60.0 },
                    "{dt} {t} {error}"
                );
            }
        }
    }

    #[test]
    fn derivative_by_the_delay_is_minus_the_slope() {
        let delay = Dual::<1>::parameter(0.02, 0);
        let mut line = DelayLine::new();
        for i in 0..100 {
            let t = f64::from(i) * 1e-3;
            line.push(Dual::of(5.0 * t), Dual::of(1e-3), delay);
        }
        assert!((line.back(delay).slope[0] + 5.0).abs() < 1e-9);
    }
}
