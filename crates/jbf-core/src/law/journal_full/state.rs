//! The state of the full model.

use crate::law::journal::Loaded;
use crate::real::Real;

/// Place and velocity of the journal's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    pub(super) xy: [T; 2],
    /// What rounding kept out of `xy` so far.
    pub(super) kept: [T; 2],
    /// Rate of `xy`, per unit of dimensionless time.
    pub(super) velocity: [T; 2],
    pub(super) loaded: Loaded<T>,
    /// The rates have not yet met this load: the next step must follow their fall.
    pub(super) fresh: bool,
    /// How often a step had to be held inside the bearing, because `dt_s` was too coarse
    /// or the input not finite.
    pub clamped: u32,
}

impl<T: Real> State<T> {
    /// At rest at a given eccentricity ratio and attitude angle (rad).
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

    /// `eps cos(phi)` and `eps sin(phi)`.
    #[inline]
    pub fn xy(&self) -> [T; 2] {
        self.xy
    }

    /// Their rates, per unit of dimensionless time.
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
