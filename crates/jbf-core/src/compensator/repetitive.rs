//! Repetitive compensation: learns the correction of a periodic task from one period (lap) to the
//! next.
//!
//! ```text
//! u_r(phase) <- Q [ u_r(phase) ] - g e(phase + lead)
//! ```
//!
//! Here Q is a three-point zero-phase smoothing filter. The filter prevents the growth of high
//! frequencies, which cannot be learned. The lap has `N` cells and is interpolated linearly between
//! them.
//!
//! Source: Tung, Anwar & Tomizuka (1993); Tomizuka, Tsao & Chew (1989) for Q; Cohn (1998), section
//! 2.4.1.

use super::{Compensator, Input, Output};
use crate::error::{check, positive, within, Error};
use crate::real::Real;

/// Compensator that learns a periodic correction of `N` values from the control error of each lap.
#[derive(Clone, Copy, Debug)]
pub struct Repetitive<T, const N: usize> {
    gain: T,
    smooth: T,
    cell_per_step: f32,
    /// Inverse of the number of steps per cell, the weight of one error in the mean error of a
    /// cell.
    inverse_steps: T,
    steps_per_lap: u32,
    lead_cells: u32,
    limit_v: T,
}

/// Learned correction over the lap, V, and the position in the lap.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "T: serde::Serialize",
        deserialize = "T: serde::Deserialize<'de>"
    ))
)]
pub struct State<T, const N: usize> {
    #[cfg_attr(feature = "serde", serde(with = "serde_big_array::BigArray"))]
    memory_v: [T; N],
    step: u32,
    cell: u32,
    error_sum: T,
}

impl<T: Real, const N: usize> Repetitive<T, N> {
    /// Creates a compensator for a lap of `steps_per_lap` steps of `dt_s`.
    ///
    /// - `gain`: learning gain, V per unit of error and lap.
    /// - `smooth`: smoothing, 0 to 0.5.
    /// - `lead_s`: delay between the output and its effect on the error, s.
    /// - `limit_v`: largest value of a cell, V.
    ///
    /// # Errors
    /// Reports the name of the number that violates its rule. A lap must have at least as many
    /// steps as cells.
    pub fn new(
        steps_per_lap: u32,
        gain: f64,
        smooth: f64,
        lead_s: f64,
        limit_v: f64,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("gain", gain)?;
        positive("limit_v", limit_v)?;
        positive("dt_s", dt_s)?;
        check(N >= 4, "cells", N as f64, "must be at least 4")?;
        check(
            steps_per_lap as usize >= N,
            "steps_per_lap",
            f64::from(steps_per_lap),
            "must be at least the number of cells",
        )?;
        within("smooth", smooth, [0.0, 0.5])?;
        let steps = f64::from(steps_per_lap);
        let lead = libm::round(lead_s / dt_s / steps * N as f64);
        check(
            lead >= 0.0 && lead < N as f64,
            "lead_s",
            lead_s,
            "must be zero or positive, and below a lap",
        )?;
        Ok(Self {
            gain: T::of(gain),
            smooth: T::of(smooth),
            cell_per_step: (N as f64 / steps) as f32,
            inverse_steps: T::of(N as f64 / steps),
            steps_per_lap,
            lead_cells: lead as u32,
            limit_v: T::of(limit_v),
        })
    }

    /// Updates the learned correction from the mean control error in `cell`.
    #[inline]
    fn teach(&self, state: &mut State<T, N>, cell: u32, error: T) {
        let n = N as u32;
        let at = (cell % n + n - self.lead_cells) % n;
        let value = |i: u32| {
            state
                .memory_v
                .get((i % n) as usize)
                .copied()
                .unwrap_or(T::ZERO)
        };
        let (before, here, after) = (value(at + n - 1), value(at), value(at + 1));
        let blurred = here + self.smooth * T::of(0.5) * (before + after - here - here);
        let next = (blurred - self.gain * error)
            .max(-self.limit_v)
            .min(self.limit_v);
        if let Some(slot) = state.memory_v.get_mut(at as usize) {
            *slot = next;
        }
    }
}

impl<T: Real, const N: usize> Compensator<T> for Repetitive<T, N> {
    type State = State<T, N>;

    fn start(&self) -> State<T, N> {
        State {
            memory_v: [T::ZERO; N],
            step: 0,
            cell: 0,
            error_sum: T::ZERO,
        }
    }

    #[inline]
    fn step(&self, state: &mut State<T, N>, input: &Input<T>) -> Output<T> {
        let n = N as u32;
        let at = state.step as f32 * self.cell_per_step;
        let cell = (at as u32).min(n - 1);
        if cell != state.cell {
            let error = state.error_sum * self.inverse_steps;
            if input.may_learn {
                self.teach(state, state.cell, error);
            }
            state.error_sum = T::ZERO;
            state.cell = cell;
        }
        state.error_sum += input.error;
        state.step += 1;
        if state.step >= self.steps_per_lap {
            state.step = 0;
        }
        let low = state.memory_v.get(cell as usize).copied();
        let high = state.memory_v.get(((cell + 1) % n) as usize).copied();
        let share = T::of(f64::from(at - cell as f32));
        let sum_v = match (low, high) {
            (Some(low), Some(high)) => low + (high - low) * share,
            _ => T::ZERO,
        };
        Output::of(sum_v, [sum_v, T::ZERO])
    }
}
