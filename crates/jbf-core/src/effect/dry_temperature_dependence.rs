//! Temperature-dependent dry friction: dry friction multiplied by `1 + a (T - T_0)`, T the recorded
//! temperature.
//!
//! Source: Bittencourt & Gunnarsson (2012), whose measurements show that the static friction of a
//! robot joint is linear in the temperature; Simoni et al. (2019), who use a polynomial. Thermal
//! expansion changes the preload of a gear, a bearing or a seal. The dry friction is limited to
//! values of zero and above.

use super::vogel::REFERENCE;
use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction that depends on the recorded temperature.
#[derive(Clone, Copy, Debug)]
pub struct DryTemperatureDependence<T> {
    slope_1_k: T,
    reference_c: T,
}

impl<T: Real> Effect<T> for DryTemperatureDependence<T> {
    const INFO: Info = Info::new("dry_temperature_dependence", Stage::Contact)
        .summary("dry friction that rises or falls with the recorded temperature")
        .equation("F_c -> F_c (1 + a (T - T_0)), T the recorded temperature; never below zero")
        .source("Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits(
            "linear in the temperature; extrapolation beyond the recorded temperatures \
                 is not reliable",
        )
        .parameters(&[
            Parameter::new(
                "a_1_k",
                "1/K",
                "relative change of the dry friction per kelvin",
                [-0.2, 0.2],
                &[-0.01],
            )
            .null(0.0),
            REFERENCE,
        ])
        .needs(&[Need::NoFilm, Need::Temperatures]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            slope_1_k: parameters[0],
            reference_c: parameters[1],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for DryTemperatureDependence<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        if let Some(temperature_c) = journal.temperature_c {
            let warmer_k = temperature_c - self.reference_c;
            sliding.jump *= (T::ONE + self.slope_1_k * warmer_k).max(T::ZERO);
        }
    }
}
