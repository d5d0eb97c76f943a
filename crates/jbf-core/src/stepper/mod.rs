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

/// System of differential equations `state' = slope(state, input)` with `N` states and one input.
pub trait System<T: Real, const N: usize> {
    /// Returns the time derivative of the state.
    fn slope(&self, state: &[T; N], input: T) -> [T; N];

    /// Returns the time derivative of the state at the start of a step; a system may know more
    /// about this state than `state` contains.
    #[inline(always)]
    fn slope_at_start(&self, state: &[T; N], input: T) -> [T; N] {
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
        state: &mut [T; N],
        input: [T; 3],
        dt: T,
    );
}

/// Computes `state + slope * dt`.
#[inline(always)]
fn along<T: Real, const N: usize>(state: &[T; N], slope: &[T; N], dt: T) -> [T; N] {
    let mut moved = *state;
    for (m, s) in moved.iter_mut().zip(slope.iter()) {
        *m += *s * dt;
    }
    moved
}
