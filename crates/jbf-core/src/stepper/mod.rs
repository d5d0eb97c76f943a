//! Integration methods with a fixed step, one per file.
//!
//! A method is independent of friction: it advances any [`System`] whose input is known at the
//! start, middle and end of the step.

mod euler;
mod rk4;
mod rodas3;
pub(crate) mod rodas5p;
pub(crate) mod rodas5p_tableau;
mod stiff;

pub use euler::Euler;
pub use rk4::Rk4;
pub use rodas3::Rodas3;
pub use rodas5p::Rodas5P;
pub use stiff::{Linear, SecondOrder, ShiftedSolver, StiffStepper, StiffSystem, TwoByTwo};

use crate::real::Real;
use nalgebra::SVector;

/// System of differential equations `state' = slope(state, input)` with `N` states and one input.
pub trait System<T: Real, const N: usize> {
    /// Returns the time derivative of the state.
    fn slope(&self, state: &SVector<T, N>, input: T) -> SVector<T, N>;

    /// Returns the time derivative of the state at the start of a step; a system may know more
    /// about this state than `state` contains.
    #[inline(always)]
    fn slope_at_start(&self, state: &SVector<T, N>, input: T) -> SVector<T, N> {
        self.slope(state, input)
    }
}

/// Explicit integration method with a fixed step.
pub trait Stepper {
    /// Advances `state` by `dt`; `input` contains the input at the start, middle and end of the
    /// step.
    fn step<T: Real, S: System<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut SVector<T, N>,
        input: [T; 3],
        dt: T,
    );
}

/// Computes `state + slope * dt`.
///
/// The loop over the components takes 3 % fewer instructions per step on a Cortex-M4F than the
/// expression of vectors.
#[inline(always)]
fn along<T: Real, const N: usize>(
    state: &SVector<T, N>,
    slope: &SVector<T, N>,
    dt: T,
) -> SVector<T, N> {
    let mut moved = *state;
    for i in 0..N {
        moved[i] += slope[i] * dt;
    }
    moved
}
