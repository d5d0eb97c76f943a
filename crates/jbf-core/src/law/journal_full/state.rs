//! State of the journal law with inertia.

use crate::law::journal::Loaded;
use crate::real::Real;

/// Position and velocity of the journal centre, under the present load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    pub(super) xy: [T; 2],
    /// Accumulated rounding error of `xy`.
    pub(super) kept: [T; 2],
    /// Derivative of `xy` with respect to dimensionless time.
    pub(super) velocity: [T; 2],
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
            xy: [eps * phi_rad.cos(), eps * phi_rad.sin()],
            kept: [T::ZERO; 2],
            velocity: [T::ZERO; 2],
            loaded,
            fresh: true,
            clamped: 0,
        }
    }

    /// Returns the eccentricity ratio.
    #[inline]
    pub fn eps(&self) -> T {
        (self.xy[0] * self.xy[0] + self.xy[1] * self.xy[1]).sqrt()
    }

    /// Returns the position `eps cos(phi)` and `eps sin(phi)`.
    #[inline]
    pub fn xy(&self) -> [T; 2] {
        self.xy
    }

    /// Returns the derivative of the position with respect to dimensionless time.
    #[inline]
    pub fn velocity(&self) -> [T; 2] {
        self.velocity
    }

    /// Returns the transition eccentricity under the present load.
    #[inline]
    pub fn eps_tr(&self) -> T {
        self.loaded.eps_tr
    }
}
