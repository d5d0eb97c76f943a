//! Spring: a force that is proportional to the position, `+ k x`.
//!
//! Return springs of valves and throttles, cables, and the springs that balance a weight act in
//! motion and at rest. The force at the position zero, such as a preload, is the
//! effect `sensor_offset`.
//!
//! Source: Hooke's law.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Linear spring between the load and the frame.
#[derive(Clone, Copy, Debug)]
pub struct Spring<T> {
    stiffness_n_m: T,
}

described! {
    named_effect Spring = Info::new::<T, Self>("spring", Stage::Other)
        .summary("spring between the load and the frame: a force proportional to the position")
        .equation("F -> F + k x, x the position of the surface, m")
        .transmitted()
        .source("Hooke's law")
        .limits(
            "a linear spring without damping; the position must be absolute or have the same \
                 zero in every run; the force at the position zero is sensor_offset",
        )
        .needs(&[Need::NoFilm, Need::Position]);
    k = "k", "N/m", "stiffness; negative if the spring pushes the load away from zero",
        [-1e9, 1e9], [1.0] null(0.0);
}

impl<T: Real> Spring<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { stiffness_n_m: p.k }
    }
}

impl<T: Real> Effect<T> for Spring<T> {
    /// Radius that converts an angle to a position, m; it is constant.
    type State = T;

    const HAS_MEMORY: bool = false;

    fn start(&self, _motion: &Motion<T>, rig: &Rig<T>) -> T {
        rig.radius_m
    }

    #[inline(always)]
    fn add_friction(
        &self,
        radius_m: &T,
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let force_n = self.stiffness_n_m * journal.angle_rad * *radius_m;
        sum_n.smooth += force_n;
        *transmitted_n += force_n;
    }
}
