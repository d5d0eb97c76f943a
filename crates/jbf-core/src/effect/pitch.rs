//! Pitch (spatial period) of the travel and phase within it, as used by `cogging` and
//! `pitch_ripple`.

use super::Parameter;
use crate::page::Start;
use crate::real::Real;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Description of the parameter `pitch`, which is fitted.
pub(super) const PITCH: Parameter = Parameter::new(
    "pitch",
    "m",
    "length of one period, at the radius",
    [1e-6, 1e3],
    &[0.5, 0.2],
)
.log()
.start(Start::Pitch);

/// Description of the parameter `phase_rad`, the phase at which a period begins.
pub(super) const PHASE: Parameter = Parameter::new(
    "phase_rad",
    "rad",
    "phase at position zero",
    [-4.0 * PI, 4.0 * PI],
    &[0.0, FRAC_PI_2, PI, -FRAC_PI_2],
)
.period(TAU)
.signed();

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
