//! Shear thinning `Ub -> Ub / (1 + (|U|/U_c)^n)`: the viscosity falls with the shear rate because
//! long molecules align.
//!
//! Source: Cross (1965), for multigrade oils such as the 10W-40 in Cohn (1998). The transition
//! speed is inversely proportional to the viscosity (mu U_tr = const), so Fb and eps_tr stay
//! constant.

use super::{Effect, Info, Lubricant, Need, Parameter, Rig, Stage};
use crate::error::ParameterError;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscosity that falls with the shear rate.
#[derive(Clone, Copy, Debug)]
pub struct ShearThinning<T> {
    inverse_speed_s_m: T,
    exponent: T,
}

impl<T: Real> Effect<T> for ShearThinning<T> {
    const INFO: Info = Info::new("shear_thinning", Stage::Lubricant)
        .summary("multigrade oil whose viscosity falls with the shear rate")
        .equation("Ub -> Ub / (1 + (|U|/U_c)^n)")
        .source("Cross 1965")
        .limits("shear rate proportional to the speed; changes of the film thickness are neglected")
        .parameters(&[
            Parameter::new(
                "U_c_m_s",
                "m/s",
                "speed at which the viscosity has halved",
                [1e-4, 1e6],
                &[0.12, 0.6],
            )
            .log()
            .null(f64::INFINITY),
            Parameter::new("n", "-", "steepness", [0.1, 8.0], &[1.2]).log(),
        ])
        .needs(&[Need::Film]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            inverse_speed_s_m: T::ONE / parameters[0],
            exponent: parameters[1],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Lubricant<T> for ShearThinning<T> {
    #[inline(always)]
    fn factor(&self, _state: &(), journal: &JournalMotion<T>) -> T {
        let shear = journal.velocity_m_s.abs() * self.inverse_speed_s_m;
        T::ONE / (T::ONE + shear.powf(self.exponent))
    }
}
