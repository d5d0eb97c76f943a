//! RODAS3, a Rosenbrock method of order three (Sandu, Verwer, Blom, Spee, Carmichael & Potra,
//! Atmospheric Environment 31, 1997).
//!
//! The method is L-stable and stiffly accurate. It also has order three for differential-algebraic
//! systems, which the equations of the journal with inertia approach as the mass number approaches
//! zero.
//!
//! The method suits a control loop because a Rosenbrock step has a fixed computing time, unlike a
//! Newton iteration. In 2 ms the film moves so little that the error of a method of order three is
//! far below that of a sensor: 7e-6 of the peak of the friction for the model with inertia at 2
//! rad/s, with 140 ns per step. [`Rodas5P`](super::Rodas5P) takes 340 ns and is not more accurate
//! there, because the remaining error is that of the kink of |U| inside a step. A step evaluates
//! two slopes in addition to the linearisation.

use super::stiff::{Linear, ShiftedSolver, StiffStepper, StiffSystem};
use crate::real::Real;
use nalgebra::SVector;

/// L-stable Rosenbrock method RODAS3 of order three.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rodas3;

impl StiffStepper for Rodas3 {
    #[inline]
    fn step<T: Real, S: StiffSystem<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut SVector<T, N>,
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
        let right = |f: SVector<T, N>, sums: SVector<T, N>, share: f64| {
            f + sums * inverse_dt + by_input * (T::of(share) * change)
        };

        let k1 = solver.solve(&right(slope, SVector::zeros(), 0.5));
        let k2 = solver.solve(&right(slope, k1 * T::of(4.0), 1.5));
        let at = *state + k1 * T::of(2.0);
        let fewer = k1 - k2;
        let k3 = solver.solve(&right(system.slope(&at, end), fewer, 0.0));
        let at = at + k3;
        let last = fewer - k3 * T::of(8.0 / 3.0);
        let k4 = solver.solve(&right(system.slope(&at, end), last, 0.0));
        *state = at + k4;
    }
}
