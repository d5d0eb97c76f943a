//! Friction proportional to the transmitted force: `+ mu |F_t| sgn(v)`.
//!
//! `F_t` is the force of other effects of the chain that the transmission carries: a weight
//! (`gravity`), a `spring`, a mass (`inertia`), a constant load (`sensor_offset`). For a recorded load, use
//! `dry_load_dependence`, which includes the friction of a force `k L`. This effect is for a load
//! that is not recorded and that the model also estimates.
//!
//! Gears and screws lose a fraction `mu_d` of `F_t` in forward driving (`F_t v > 0`) and another
//! fraction `mu_b` in back-driving. With half their sum `mu` and half their difference `d`,
//! friction is `mu |F_t| sgn(v) + d F_t`, in motion and at rest. The difference term is
//! proportional to the load itself. No record of the drive force distinguishes `1 + d` from a
//! larger weight or mass (for a recorded load it is the `k` of `zero_load_dependence`). It
//! therefore has no parameter.
//!
//! The data determine `mu` divided by `1 + d`. With this quotient as `mu`, the product of the two
//! efficiencies is `(1 - mu)/(1 + mu)`, and the drive is self-locking for `mu` of one or more.
//!
//! Source: Hamon, Gautier & Garrec (2010) for gears and screws; Wolf & Iskandar (2018) for
//! strain-wave gears.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::Motion;
use crate::real::Real;

/// Friction proportional to the force that the transmission carries.
#[derive(Clone, Copy, Debug)]
pub struct TorqueProportional<T> {
    share: T,
}

described! {
    named_effect TorqueProportional = Info::new::<T, Self>("torque_proportional", Stage::Contact)
        .summary("friction proportional to the torque or force that the drive transmits")
        .equation(
            "F -> F + mu |F_t| sgn(v), F_t the sum of weight, spring, inertial force and offset of \
             the other effects",
        )
        .source("Hamon, Gautier & Garrec 2010; Wolf & Iskandar 2018")
        .limits(
            "the difference between driving and back-driving is part of the weight's value; \
             all inertia counts, also a rotor before the gear; the offset counts as a \
             constant load, so a large sensor offset is an error",
        )
        .needs(&[Need::NoFilm, Need::Transmitted]);
    mu = "mu", "-", "friction per transmitted force, mean of driving and back-driving",
        [0.0, 10.0], [0.1] null(0.0);
}

impl<T: Real> TorqueProportional<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { share: p.mu }
    }
}

impl<T: Real> Effect<T> for TorqueProportional<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn transmission(&self, _state: &(), sliding: &mut Friction<T>, transmitted_n: T) {
        sliding.jump += self.share * transmitted_n.abs();
    }
}
