//! Temperature-dependent viscous friction: viscous friction multiplied by `exp(B/(T - C) - B/(T_0 -
//! C))`, T the recorded temperature.
//!
//! Source: Vogel (1921), for the viscosity of an oil or of the base oil of a grease; see
//! `vogel.rs`. Bittencourt & Gunnarsson (2012) find that the viscous friction of a robot joint
//! falls exponentially with the temperature; Simoni et al. (2019) use a polynomial.

use super::vogel::{Vogel, C, REFERENCE};
use super::{Contact, Effect, Info, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction that depends on the recorded temperature.
#[derive(Clone, Copy, Debug)]
pub struct ViscousTemperatureDependence<T> {
    relation: Vogel<T>,
}

impl<T: Real> Effect<T> for ViscousTemperatureDependence<T> {
    const INFO: Info = Info::new("viscous_temperature_dependence", Stage::Contact)
        .summary("viscous friction that falls as the recorded temperature rises")
        .equation("F_v v -> F_v v exp(B/(T - C) - B/(T_0 - C)), T the recorded temperature")
        .source("Vogel 1921; Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits(
            "the lubricant has the recorded temperature; C is that of a typical oil \
                 unless specified",
        )
        .parameters(&[
            Parameter::new(
                "B_k",
                "K",
                "Vogel's B: temperature sensitivity of the viscous friction",
                [-5000.0, 5000.0],
                &[600.0],
            )
            .null(0.0),
            C,
            REFERENCE,
        ])
        .needs(&[Need::NoFilm, Need::Temperatures]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        let relation = Vogel {
            b_k: parameters[0],
            c_c: parameters[1],
            reference_c: parameters[2],
        };
        Ok(Self { relation })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Contact<T> for ViscousTemperatureDependence<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), journal: &JournalMotion<T>, sliding: &mut Friction<T>) {
        sliding.smooth *= self.relation.factor(journal.temperature_c);
    }
}
