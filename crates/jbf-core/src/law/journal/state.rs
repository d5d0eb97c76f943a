//! State of the film, and the constants of the journal law that depend on the load.

use super::film_motion::square;
use crate::real::Real;
use nalgebra::Vector2;

/// Constants of the journal law that depend on the load.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Loaded<T> {
    /// Load on the bearing, N.
    pub load_n: T,
    /// Load number `Fb`, equation (3.1) of Cohn (1998).
    pub load_number: T,
    pub(super) inverse_load_number: T,
    /// Transition eccentricity, at which asperity contact begins.
    pub eps_tr: T,
}

/// State of the film: the position of the journal in its bearing, under the present load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    pub(super) xy: Vector2<T>,
    /// Value of `x^2 + y^2` after the last step.
    pub(super) e2: T,
    /// Accumulated rounding error of `xy`.
    ///
    /// Without it, a film in single precision that moves slowly, or takes short steps, would not
    /// move.
    pub(super) kept: Vector2<T>,
    /// Constants under the present load.
    pub loaded: Loaded<T>,
    /// Number of steps after which the position was limited to the inside of the bearing, because
    /// `dt_s` was too coarse or the input not finite.
    pub clamped: u32,
}

impl<T: Real> State<T> {
    /// Creates the state at a given eccentricity ratio and attitude angle (rad).
    pub fn at(eps: T, phi_rad: T, loaded: Loaded<T>) -> Self {
        let mut state = Self {
            xy: Vector2::zeros(),
            e2: T::ZERO,
            kept: Vector2::zeros(),
            loaded,
            clamped: 0,
        };
        state.put(Vector2::new(phi_rad.cos(), phi_rad.sin()) * eps);
        state
    }

    /// Sets the position of the journal and clears its rounding error.
    pub(super) fn put(&mut self, xy: Vector2<T>) {
        self.xy = xy;
        self.e2 = square(&xy);
        self.kept = Vector2::zeros();
    }

    /// Returns the eccentricity ratio.
    #[inline]
    pub fn eps(&self) -> T {
        self.e2.sqrt()
    }

    /// Returns the position `eps cos(phi)` and `eps sin(phi)`.
    #[inline]
    pub fn xy(&self) -> Vector2<T> {
        self.xy
    }
}
