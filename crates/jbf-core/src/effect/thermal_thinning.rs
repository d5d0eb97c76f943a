//! Thermal thinning `Ub -> Ub exp(-beta T)`, `T' = q |F v| - T/tau`: friction heats the oil, which
//! lowers its viscosity.
//!
//! Source: Reynolds's exponential viscosity law; Cohn (1998), section 4.2, assumes a constant
//! temperature. The transition speed is inversely proportional to the viscosity (mu U_tr = const),
//! so Fb and eps_tr stay constant. A friction record determines only the product beta q, so the
//! state is `beta T` and the product is the parameter.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use crate::relaxation::relax;

/// Viscosity that falls when friction heats the oil.
#[derive(Clone, Copy, Debug)]
pub struct ThermalThinning<T> {
    rate_1_j: T,
    tau_s: T,
}

/// Temperature rise of the film, and the friction power.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    /// Decrease of the logarithm of the viscosity, `beta T`.
    thinned: T,
    /// Friction power at the end of the last step, W.
    power_w: T,
}

described! {
    named_effect ThermalThinning = Info::new::<T, Self>("thermal_thinning", Stage::Lubricant)
        .summary("frictional heating of the oil, which lowers its viscosity")
        .equation("Ub -> Ub exp(-h), h' = (beta q) |F v| - h/tau")
        .source("Reynolds's viscosity law; Cohn 1998, section 4.2")
        .limits("one lumped temperature, exponential viscosity, cold at the start of each run")
        .needs(&[Need::Film]);
    beta_q_1_j = "beta_q_1_j", "1/J", "decrease of log viscosity per joule of friction work",
        [0.0, 1e3], [0.03, 0.3] null(0.0);
    tau_s = "tau_s", "s", "thermal time constant of the film", [0.1, 1e5], [60.0] .log();
}

impl<T: Real> ThermalThinning<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            rate_1_j: p.beta_q_1_j,
            tau_s: p.tau_s,
        }
    }
}

impl<T: Real> Effect<T> for ThermalThinning<T> {
    type State = State<T>;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            thinned: T::ZERO,
            power_w: T::ZERO,
        }
    }

    #[inline(always)]
    fn lubricant(&self, state: &State<T>, _journal: &JournalMotion<T>, factor: &mut T) {
        *factor *= (-state.thinned).exp();
    }

    #[inline(always)]
    fn heat(&self, state: &mut State<T>, power_w: T, dt_s: T) {
        let gain = self.rate_1_j * self.tau_s;
        let heat = [state.power_w * gain, power_w * gain];
        state.thinned = relax(state.thinned, heat, dt_s / self.tau_s);
        state.power_w = power_w;
    }
}
