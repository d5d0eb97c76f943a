//! Temperature-dependent viscous friction: viscous friction multiplied by `exp(B/(T - C) - B/(T_0 -
//! C))`, T the recorded temperature.
//!
//! Source: Vogel (1921), for the viscosity of an oil or of the base oil of a grease; the constant
//! `C = -95` is valid for mineral oils of every grade (Crouch & Cameron 1961). Bittencourt &
//! Gunnarsson (2012) find that the viscous friction of a robot joint falls exponentially with the
//! temperature; Simoni et al. (2019) use a polynomial.

use super::registry::named_effect;
use super::vogel::Vogel;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscous friction that depends on the recorded temperature.
#[derive(Clone, Copy, Debug)]
pub struct ViscousTemperatureDependence<T> {
    relation: Vogel<T>,
}

described! {
    named_effect ViscousTemperatureDependence = Info::new::<T, Self>("viscous_temperature_dependence", Stage::Contact)
        .summary("viscous friction that falls as the recorded temperature rises")
        .equation("F_v v -> F_v v exp(B/(T - C) - B/(T_0 - C)), T the recorded temperature")
        .source("Vogel 1921; Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits(
            "the lubricant has the recorded temperature; C is that of a typical oil \
                 unless specified",
        )
        .needs(&[Need::NoFilm, Need::Temperatures]);
    b_k = "B_k", "K", "Vogel's B: temperature sensitivity of the viscous friction",
        [-5000.0, 5000.0], [600.0] null(0.0);
    C_c;
    T_0_c;
}

impl<T: Real> ViscousTemperatureDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        let relation = Vogel {
            b_k: p.b_k,
            c_c: p.c_c,
            reference_c: p.t_0_c,
        };
        Self { relation }
    }
}

impl<T: Real> Effect<T> for ViscousTemperatureDependence<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn contact(
        &self,
        _state: &mut (),
        _from: &JournalMotion<T>,
        journal: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        _dt_s: T,
    ) {
        sliding.smooth *= self.relation.factor(journal.temperature_c);
    }
}
