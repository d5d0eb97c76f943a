//! Friction that is a share of what the drive transmits: `+ mu |F_t| sgn(v)`.
//!
//! `F_t` is what other effects of the chain let the transmission carry: a weight (`gravity`), a mass
//! (`inertia_leak`), a constant load (`sensor_offset`). A load on record has `dry_load_dependence`, and a push `k L` has no friction here
//! that it has not there; this is for the load that nobody records, and that the model finds as well.
//!
//! Gears and screws lose one share `mu_d` of `F_t` where they drive (`F_t v > 0`) and another `mu_b`
//! where they are driven back. With half their sum `mu` and half their difference `d` friction is
//! `mu |F_t| sgn(v) + d F_t`, in motion and at rest: the difference is the load itself once more,
//! and no record of the drive's force tells `1 + d` from a larger weight or mass (of a load
//! on record it is the `k` of `zero_load_dependence`). So it has no parameter. Over `1 + d`, `mu` is what
//! is known, and `(1 - mu)/(1 + mu)` the product of the two efficiencies; from one on the drive locks.
//!
//! Source: Hamon, Gautier & Garrec (2010) for gears and screws; Wolf & Iskandar
//! (2018) for strain-wave gears.

use super::{Effect, Info, Need, Parameter, Rig, Stage, Transmission};
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::Motion;
use crate::real::Real;

/// Friction over transmitted force.
#[derive(Clone, Copy, Debug)]
pub struct TorqueProportional<T> {
    share: T,
}

impl<T: Real> Effect<T> for TorqueProportional<T> {
    const INFO: Info = Info::new("torque_proportional", Stage::Contact)
        .summary("friction that is a share of the torque or force that the drive transmits")
        .equation(
            "F -> F + mu |F_t| sgn(v), F_t the weight, mass and offset that other effects add",
        )
        .source("Hamon, Gautier & Garrec 2010; Wolf & Iskandar 2018")
        .limits(
            "what driving loses more than being driven back is in the size of the weight itself; \
             all of a mass counts, that of a rotor before the gear too, and an offset counts as a \
             constant load: a zero of the sensor that is large next to the weight is an error",
        )
        .parameters(&[Parameter::new(
            "mu",
            "-",
            "friction over transmitted force, mean of driving and being driven back",
            [0.0, 10.0],
            &[0.1],
        )
        .null(0.0)])
        .needs(&[Need::NoFilm, Need::Transmitted]);
    type State = ();

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            share: parameters[0],
        })
    }

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

impl<T: Real> Transmission<T> for TorqueProportional<T> {
    #[inline(always)]
    fn apply(&self, _state: &(), transmitted_n: T, sliding: &mut Friction<T>) {
        sliding.jump += self.share * transmitted_n.abs();
    }
}
