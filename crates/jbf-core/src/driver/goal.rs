//! The error that a step may make, measured in friction.

use super::Film;
use crate::law::journal::Loaded;
use crate::real::Real;
use crate::root::sqrt;

/// Share of the tolerance that one step may err by: errors mostly die before the next. With
/// inertia they die later.
const STEP_SHARE: f64 = 4.0;
const STEP_SHARE_INERTIA: f64 = 1.5;
/// An error far from the asperities weighs this much of one where they carry the whole load: it
/// is forgotten in part before they touch.
const FREE_WEIGHT: f64 = 0.1;
/// Share of the gap between journal and wall that a step may err by, whatever the tolerance.
const GAP_SHARE: f64 = 0.01;
/// Errors of place below this are rounding.
const ROUNDING: f64 = 2e-14;

/// How the step follows from the error. On films that are stiff at their step the estimate falls
/// with the fourth power of the step, not the fifth of the smooth theory.
#[inline]
pub(super) fn inverse_root(share: f64) -> f64 {
    1.0 / sqrt(sqrt(share))
}

/// The error that a step may make.
pub(super) struct Goal {
    tolerance: f64,
    /// `d f / d eps` over the depth of touch.
    steepness: f64,
    /// Least weight of an error of place.
    least: f64,
    /// Eccentricity may pass eps_tr by this much unseen: friction errs by the square.
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

    /// An error of place over what is allowed.
    #[inline]
    pub(super) fn share(&self, error: [f64; 2], depth: f64, eps: f64) -> f64 {
        let size = sqrt(error[0] * error[0] + error[1] * error[1]);
        let weight = (self.steepness * depth).max(self.least);
        let allowed = (self.tolerance / weight).min(GAP_SHARE * (1.0 - eps));
        size / allowed.max(ROUNDING)
    }
}
