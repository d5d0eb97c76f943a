//! Explicit Euler method `y += dt f(y)`, of first order, as in the 2 ms loop of Cohn (1998).
//!
//! (Cohn prints `eps_{i+1} = eps' dt`, in which the state itself is missing.)

use super::{along, Stepper, System};
use crate::real::Real;
use nalgebra::SVector;

/// Explicit Euler method.
#[derive(Clone, Copy, Debug, Default)]
pub struct Euler;

impl Stepper for Euler {
    #[inline(always)]
    fn step<T: Real, S: System<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut SVector<T, N>,
        input: [T; 3],
        dt: T,
    ) {
        let slope = system.slope_at_start(state, input[0]);
        *state = along(state, &slope, dt);
    }
}
