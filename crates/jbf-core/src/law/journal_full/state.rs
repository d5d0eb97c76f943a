//! State of the journal law with inertia.

use crate::law::journal::{square, Loaded};
use crate::real::Real;
use nalgebra::Vector2;

/// Position and velocity of the journal centre, under the present load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    /// Position `eps cos(phi)` and `eps sin(phi)`.
    pub xy: Vector2<T>,
    /// Accumulated rounding error of `xy`.
    pub(super) kept: Vector2<T>,
    /// Derivative of `xy` with respect to dimensionless time.
    pub velocity: Vector2<T>,
    pub(super) loaded: Loaded<T>,
    /// True if the velocity has not yet relaxed under the present load; the next step must resolve
    /// the relaxation.
    pub(super) fresh: bool,
    /// Number of steps after which the position was limited to the inside of the bearing, because
    /// `dt_s` was too coarse or the input not finite.
    pub clamped: u32,
}

impl<T: Real> State<T> {
    /// Creates the state at rest at a given eccentricity ratio and attitude angle (rad).
    pub fn at(eps: T, phi_rad: T, loaded: Loaded<T>) -> Self {
        Self {
            xy: Vector2::new(phi_rad.cos(), phi_rad.sin()) * eps,
            kept: Vector2::zeros(),
            velocity: Vector2::zeros(),
            loaded,
            fresh: true,
            clamped: 0,
        }
    }

    /// Returns the eccentricity ratio.
    #[inline]
    pub fn eps(&self) -> T {
        square(&self.xy).sqrt()
    }
}
