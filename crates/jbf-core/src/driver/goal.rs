//! Error allowed per step, measured in friction.

use super::Film;
use crate::law::journal::Loaded;
use crate::real::Real;
use crate::root::sqrt;

/// Error allowed per step, in multiples of the tolerance. Most errors decay before the next step;
/// with inertia they decay more slowly.
const STEP_SHARE: f64 = 4.0;
const STEP_SHARE_INERTIA: f64 = 1.5;
/// Weight of an error far from asperity contact, relative to an error where the asperities carry
/// the whole load. It decays in part before the asperities touch.
const FREE_WEIGHT: f64 = 0.1;
/// Largest error per step, as a fraction of the gap between journal and wall, for any tolerance.
const GAP_SHARE: f64 = 0.01;
/// Position errors below this value are rounding.
const ROUNDING: f64 = 2e-14;

/// Step factor as a function of the error share.
///
/// For films that are stiff at their step, the error estimate falls with the fourth power of the
/// step, not with the fifth power of the smooth theory.
#[inline]
pub(super) fn inverse_root(share: f64) -> f64 {
    1.0 / sqrt(sqrt(share))
}

/// Error allowed per step.
pub(super) struct Goal {
    tolerance: f64,
    /// Slope `d f / d eps` per depth of contact.
    steepness: f64,
    /// Least weight of a position error.
    least: f64,
    /// Amount by which the eccentricity may pass eps_tr undetected; the friction error is quadratic
    /// in it.
    pub(super) band: f64,
}

impl Goal {
    pub(super) fn new<T: Real, F: Film<T, N>, const N: usize>(
        film: &F,
        loaded: &Loaded<T>,
        tolerance: f64,
    ) -> Self {
        let journal = film.journal();
        let (fb, k0) = (loaded.load_number.value(), journal.k0.value());
        let f_m = journal.f_m.value().max(1e-3);
        let steepness = 2.0 * f_m * k0 / fb;
        Self {
            tolerance: tolerance
                * if N > 2 {
                    STEP_SHARE_INERTIA
                } else {
                    STEP_SHARE
                },
            steepness,
            least: FREE_WEIGHT * 2.0 * f_m * sqrt(k0 / fb),
            band: sqrt(0.01 * tolerance * fb / (k0 * f_m)),
        }
    }

    /// Position error relative to the allowed error.
    #[inline]
    pub(super) fn share(&self, error: [f64; 2], depth: f64, eps: f64) -> f64 {
        let size = sqrt(error[0] * error[0] + error[1] * error[1]);
        let weight = (self.steepness * depth).max(self.least);
        let allowed = (self.tolerance / weight).min(GAP_SHARE * (1.0 - eps));
        size / allowed.max(ROUNDING)
    }
}
