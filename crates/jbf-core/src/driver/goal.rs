//! Error control of the integration: largest error of a step, in terms of the friction coefficient.

use super::Film;
use crate::law::journal::Loaded;
use crate::real::Real;
use crate::root::sqrt;

/// Error that one step without inertia may have, in multiples of the tolerance.
///
/// The tolerance may be exceeded because most errors decay before the next step. With inertia, they
/// decay more slowly (`STEP_SHARE_INERTIA`).
const STEP_SHARE: f64 = 4.0;
const STEP_SHARE_INERTIA: f64 = 1.5;
/// Weight of a position error far from asperity contact, relative to an error where the asperities
/// carry the whole load.
///
/// Such an error decays in part before the asperities touch.
const FREE_WEIGHT: f64 = 0.1;
/// Largest position error per step, as a fraction of the gap between journal and wall, for any
/// tolerance.
const GAP_SHARE: f64 = 0.01;
/// Largest position error (eccentricity ratio) that is treated as rounding error.
const ROUNDING: f64 = 2e-14;

/// Factor on the step size for the next trial, from the error of the present step divided by the
/// allowed error (`share`).
///
/// The exponent is -1/4: for equations that are stiff at the step size, the error estimate is
/// proportional to the fourth power of the step, not to the fifth power of the theory for smooth
/// solutions.
#[inline]
pub(super) fn inverse_root(share: f64) -> f64 {
    1.0 / sqrt(sqrt(share))
}

/// Weights that convert a position error of a step into an error relative to the allowed error.
pub(super) struct Goal {
    tolerance: f64,
    /// Increase of the slope `d f / d eps` of the friction coefficient with the depth of contact
    /// `eps - eps_tr`.
    steepness: f64,
    /// Smallest weight of a position error in the friction coefficient.
    least: f64,
    /// Amount by which the eccentricity ratio may pass eps_tr undetected; the resulting error of
    /// the friction is quadratic in it.
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

    /// Position error of a step divided by the allowed error; a value above one rejects the step.
    #[inline]
    pub(super) fn share(&self, error: [f64; 2], depth: f64, eps: f64) -> f64 {
        let size = sqrt(error[0] * error[0] + error[1] * error[1]);
        let weight = (self.steepness * depth).max(self.least);
        let allowed = (self.tolerance / weight).min(GAP_SHARE * (1.0 - eps));
        size / allowed.max(ROUNDING)
    }
}
