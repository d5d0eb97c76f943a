//! Classical Runge-Kutta method of order four (Kutta 1901).

use super::{along, Stepper, System};
use crate::real::Real;
use nalgebra::SVector;

/// Classical Runge-Kutta method of order four.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rk4;

impl Stepper for Rk4 {
    #[inline(always)]
    fn step<T: Real, S: System<T, N>, const N: usize>(
        &self,
        system: &S,
        state: &mut SVector<T, N>,
        input: [T; 3],
        dt: T,
    ) {
        let half = dt * T::of(0.5);
        let k1 = system.slope_at_start(state, input[0]);
        let k2 = system.slope(&along(state, &k1, half), input[1]);
        let k3 = system.slope(&along(state, &k2, half), input[1]);
        let k4 = system.slope(&along(state, &k3, dt), input[2]);
        let sixth = dt * T::of(1.0 / 6.0);
        let two = T::of(2.0);
        for i in 0..N {
            state[i] += (k1[i] + (k2[i] + k3[i]) * two + k4[i]) * sixth;
        }
    }
}
