//! State of the full model.

use crate::law::journal::Loaded;
use crate::real::Real;

/// Position and velocity of the journal centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    pub(super) xy: [T; 2],
    /// Accumulated rounding error of `xy`.
    pub(super) kept: [T; 2],
    /// Rate of change of `xy`, per unit of dimensionless time.
    pub(super) velocity: [T; 2],
    pub(super) loaded: Loaded<T>,
    /// True if the rates have not yet relaxed under this load; the next step must resolve it.
    pub(super) fresh: bool,
    /// Number of steps that were limited to the inside of the bearing, because `dt_s` was too
    /// coarse or the input not finite.
    pub clamped: u32,
}

impl<T: Real> State<T> {
    /// State at rest at a given eccentricity ratio and attitude angle (rad).
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

    /// Eccentricity ratio.
    #[inline]
    pub fn eps(&self) -> T {
        (self.xy[0] * self.xy[0] + self.xy[1] * self.xy[1]).sqrt()
    }

    /// Position `eps cos(phi)` and `eps sin(phi)`.
    #[inline]
    pub fn xy(&self) -> [T; 2] {
        self.xy
    }

    /// Rate of change of the position, per unit of dimensionless time.
    #[inline]
    pub fn velocity(&self) -> [T; 2] {
        self.velocity
    }

    /// Transition eccentricity under the present load.
    #[inline]
    pub fn eps_tr(&self) -> T {
        self.loaded.eps_tr
    }
}
