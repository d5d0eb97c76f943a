//! Thermal thinning `Ub -> Ub exp(-beta T)`, `T' = q |F v| - T/tau`: friction heats the oil, which
//! lowers its viscosity.
//!
//! Source: Reynolds's exponential viscosity law; Cohn (1998), section 4.2, assumes a constant
//! temperature. The transition speed is inversely proportional to the viscosity (mu U_tr = const),
//! so Fb and eps_tr stay constant. A friction record determines only the product beta q, so the
//! state is `beta T` and the product is the parameter.

use super::{Effect, Info, Lubricant, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
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

impl<T: Real> Effect<T> for ThermalThinning<T> {
    const INFO: Info = Info::new("thermal_thinning", Stage::Lubricant)
        .summary("frictional heating of the oil, which lowers its viscosity")
        .equation("Ub -> Ub exp(-h), h' = (beta q) |F v| - h/tau")
        .source("Reynolds's viscosity law; Cohn 1998, section 4.2")
        .limits("one lumped temperature, exponential viscosity, cold at the start of each run")
        .parameters(&[
            Parameter::new(
                "beta_q_1_j",
                "1/J",
                "decrease of log viscosity per joule of friction work",
                [0.0, 1e3],
                &[0.03, 0.3],
            )
            .null(0.0),
            Parameter::new(
                "tau_s",
                "s",
                "thermal time constant of the film",
                [0.1, 1e5],
                &[60.0],
            )
            .log(),
        ])
        .needs(&[Need::Film]);
    type State = State<T>;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            rate_1_j: parameters[0],
            tau_s: parameters[1],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            thinned: T::ZERO,
            power_w: T::ZERO,
        }
    }
}

impl<T: Real> Lubricant<T> for ThermalThinning<T> {
    #[inline(always)]
    fn factor(&self, state: &State<T>, _journal: &JournalMotion<T>) -> T {
        (-state.thinned).exp()
    }

    #[inline(always)]
    fn step(&self, state: &mut State<T>, power_w: T, dt_s: T) {
        let gain = self.rate_1_j * self.tau_s;
        let heat = [state.power_w * gain, power_w * gain];
        state.thinned = relax(state.thinned, heat, dt_s / self.tau_s);
        state.power_w = power_w;
    }
}
