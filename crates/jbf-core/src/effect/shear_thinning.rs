//! Shear thinning `Ub -> Ub / (1 + (|U|/U_c)^n)`: the viscosity falls with the shear rate because
//! long molecules align.
//!
//! Source: Cross (1965), for multigrade oils such as the 10W-40 in Cohn (1998). The transition
//! speed is inversely proportional to the viscosity (mu U_tr = const), so Fb and eps_tr stay
//! constant.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Viscosity that falls with the shear rate.
#[derive(Clone, Copy, Debug)]
pub struct ShearThinning<T> {
    inverse_speed_s_m: T,
    exponent: T,
}

described! {
    named_effect ShearThinning = Info::new::<T, Self>("shear_thinning", Stage::Lubricant)
        .summary("multigrade oil whose viscosity falls with the shear rate")
        .equation("Ub -> Ub / (1 + (|U|/U_c)^n)")
        .source("Cross 1965")
        .limits("shear rate proportional to the speed; changes of the film thickness are neglected")
        .needs(&[Need::Film]);
    u_c_m_s = "U_c_m_s", "m/s", "speed at which the viscosity has halved",
        [1e-4, 1e6], [0.12, 0.6] null(f64::INFINITY) .log();
    n = "n", "-", "steepness", [0.1, 8.0], [1.2] .log();
}

impl<T: Real> ShearThinning<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            inverse_speed_s_m: T::ONE / p.u_c_m_s,
            exponent: p.n,
        }
    }
}

impl<T: Real> Effect<T> for ShearThinning<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn lubricant(&self, _state: &(), journal: &JournalMotion<T>, factor: &mut T) {
        let shear = journal.velocity_m_s.abs() * self.inverse_speed_s_m;
        *factor *= T::ONE / (T::ONE + shear.powf(self.exponent));
    }
}
