//! Temperature-dependent dry friction: dry friction multiplied by `1 + a (T - T_0)`, T the recorded
//! temperature.
//!
//! Source: Bittencourt & Gunnarsson (2012), whose measurements show that the static friction of a
//! robot joint is linear in the temperature; Simoni et al. (2019), who use a polynomial. Thermal
//! expansion changes the preload of a gear, a bearing or a seal. The dry friction is limited to
//! values of zero and above.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Dry friction that depends on the recorded temperature.
#[derive(Clone, Copy, Debug)]
pub struct DryTemperatureDependence<T> {
    slope_1_k: T,
    reference_c: T,
}

described! {
    named_effect DryTemperatureDependence = Info::new::<T, Self>("dry_temperature_dependence", Stage::Contact)
        .summary("dry friction that rises or falls with the recorded temperature")
        .equation("F_c -> F_c (1 + a (T - T_0)), T the recorded temperature; never below zero")
        .source("Bittencourt & Gunnarsson 2012; Simoni et al. 2019")
        .limits(
            "linear in the temperature; extrapolation beyond the recorded temperatures \
                 is not reliable",
        )
        .needs(&[Need::NoFilm, Need::Temperatures]);
    a_1_k = "a_1_k", "1/K", "relative change of the dry friction per kelvin",
        [-0.2, 0.2], [-0.01] null(0.0);
    T_0_c;
}

impl<T: Real> DryTemperatureDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            slope_1_k: p.a_1_k,
            reference_c: p.t_0_c,
        }
    }
}

impl<T: Real> Effect<T> for DryTemperatureDependence<T> {
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
        if let Some(temperature_c) = journal.temperature_c {
            let warmer_k = temperature_c - self.reference_c;
            sliding.jump *= (T::ONE + self.slope_1_k * warmer_k).max(T::ZERO);
        }
    }
}
