//! RODAS3, a Rosenbrock method of order three (Sandu, Verwer, Blom, Spee, Carmichael & Potra,
//! Atmospheric Environment 31, 1997).
//!
//! It is L-stable and stiffly accurate. It has order three on differential-algebraic systems too,
//! which the full bearing becomes as its mass number approaches zero.
//!
//! It suits the loop because a Rosenbrock step has a fixed cost (no Newton iteration, which may
//! need more). At 2 ms the film moves so little that order three leaves errors far below a
//! sensor's. The error is 7e-6 of the loop's peak on the full model at 2 rad/s, for 140 ns per
//! step. [`Rodas5P`](super::Rodas5P) takes 340 ns and is no better there, because the remaining
//! error comes from the kink of |U| inside a step. It evaluates two slopes in addition to the
//! linearisation; its coefficients are small fractions.

use super::stiff::{Linear, ShiftedSolver, StiffStepper, StiffSystem};
use crate::real::Real;

/// L-stable Rosenbrock method of order three.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rodas3;

impl StiffStepper for Rodas3 {
    #[inline]
    fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut [T; N],
        [start, middle, end]: [T; 3],
        dt: T,
    ) {
        let Linear {
            slope,
            jacobian,
            by_input,
        } = system.linearise(state, start);
        // Change of the input over the step at the initial rate of its parabola.
        let change = T::of(4.0) * middle - T::of(3.0) * start - end;
        let inverse_dt = T::ONE / dt;
        let solver = S::Solver::new(&jacobian, inverse_dt * T::of(2.0));
        let right = |f: &[T; N], sums: [T; N], share: f64| {
            core::array::from_fn(|i| {
                f[i] + sums[i] * inverse_dt + T::of(share) * change * by_input[i]
            })
        };

        let k1 = solver.solve(&right(&slope, [T::ZERO; N], 0.5));
        let four = core::array::from_fn(|i| T::of(4.0) * k1[i]);
        let k2 = solver.solve(&right(&slope, four, 1.5));
        let at = core::array::from_fn(|i| state[i] + T::of(2.0) * k1[i]);
        let fewer: [T; N] = core::array::from_fn(|i| k1[i] - k2[i]);
        let k3 = solver.solve(&right(&system.slope(&at, end), fewer, 0.0));
        let at = core::array::from_fn(|i| at[i] + k3[i]);
        let last = core::array::from_fn(|i| fewer[i] - T::of(8.0 / 3.0) * k3[i]);
        let k4 = solver.solve(&right(&system.slope(&at, end), last, 0.0));
        *state = core::array::from_fn(|i| at[i] + k4[i]);
    }
}
