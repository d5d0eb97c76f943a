//! Pitch (spatial period) of the travel and phase within it, as used by `cogging` and
//! `pitch_ripple`.

use crate::real::Real;
use core::f64::consts::TAU;

/// Phase angle `2 pi x/p - phi` of a spatial period.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pitch<T> {
    inverse_1_m: T,
    phase_rad: T,
}

impl<T: Real> Pitch<T> {
    pub(super) fn new(pitch_m: T, phase_rad: T) -> Self {
        Self {
            inverse_1_m: T::ONE / pitch_m,
            phase_rad,
        }
    }

    /// Phase angle at a position (m), without whole periods, which would reduce the accuracy in
    /// single precision.
    #[inline(always)]
    pub(super) fn angle(&self, place_m: T) -> T {
        let periods = place_m * self.inverse_1_m;
        let whole = T::of(libm::round(periods.value()));
        (periods - whole) * T::of(TAU) - self.phase_rad
    }
}
