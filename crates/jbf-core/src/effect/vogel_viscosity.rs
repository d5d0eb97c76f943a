//! Viscosity of the oil as a function of the recorded temperature: `Ub -> Ub m`, `t -> t/m`, `m =
//! exp(B/(T - C) - B/(T_0 - C))`.
//!
//! Source: Vogel (1921); the constant `C = -95` is valid for mineral oils of every grade (Crouch &
//! Cameron 1961). The transition speed is inversely proportional to the viscosity (mu U_tr =
//! const), so Fb and eps_tr stay constant, as in `thermal_thinning`, whose temperature is not
//! recorded. The rate of the film dynamics, U_tr/R, is proportional to 1/mu: thin oil is squeezed
//! out faster. With the time scale [`crate::Clock::Journal`], a change of the oil is therefore
//! equivalent to a change of the temperature, and one model describes runs with several oils.

use super::registry::named_effect;
use super::vogel::Vogel;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscosity that depends on the recorded temperature.
#[derive(Clone, Copy, Debug)]
pub struct VogelViscosity<T> {
    relation: Vogel<T>,
}

described! {
    named_effect VogelViscosity = Info::new::<T, Self>("vogel_viscosity", Stage::Lubricant)
        .summary("oil whose viscosity falls as the recorded temperature rises")
        .equation(
            "Ub -> Ub m, t -> t/m, m = exp(B/(T - C) - B/(T_0 - C)), T the recorded temperature",
        )
        .source(
            "Vogel 1921; Crouch & Cameron 1961 for C; Cohn 1998, section 4.2, for mu U_tr = const",
        )
        .limits(
            "the film has the recorded temperature; C is that of a typical oil unless \
             specified; the journal's inertia as at T_0; a rig viscosity without temperature \
             applies at the mean recorded temperature",
        )
        .needs(&[Need::Film, Need::Temperatures]);
    b_k = "B_k", "K", "Vogel's B: temperature sensitivity of the viscosity",
        [0.0, 5000.0], [800.0] null(0.0);
    C_c;
    T_0_c;
}

impl<T: Real> VogelViscosity<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        let relation = Vogel {
            b_k: p.b_k,
            c_c: p.c_c,
            reference_c: p.t_0_c,
        };
        Self { relation }
    }
}

impl<T: Real> Effect<T> for VogelViscosity<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn lubricant(&self, _state: &(), journal: &JournalMotion<T>, factor: &mut T) {
        *factor *= self.relation.factor(journal.temperature_c);
    }

    #[inline(always)]
    fn film_rate(&self, _state: &(), journal: &JournalMotion<T>, rate: &mut T) {
        *rate *= T::ONE / self.relation.factor(journal.temperature_c);
    }
}
