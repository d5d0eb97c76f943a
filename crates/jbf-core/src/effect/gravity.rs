//! Weight of a link: `+ G sin(theta - theta_0)`.
//!
//! Source: any textbook on robots, such as Siciliano et al. (2009), section 7.3. For an inclined
//! linear axis the weight is constant, which is the effect `sensor_offset`.
//!
//! The link of a joint that follows other joints turns with all of them. The angle theta of such a
//! link is the angle of the joint plus [`JournalMotion::weight_offset_rad`].

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Weight of a link: a force that is periodic in the angle of the shaft.
#[derive(Clone, Copy, Debug)]
pub struct Gravity<T> {
    weight_n: T,
    cos_offset: T,
    sin_offset: T,
}

described! {
    named_effect Gravity = Info::new::<T, Self>("gravity", Stage::Other)
        .summary("weight of a link, or an unbalance, that the drive carries")
        .equation("F -> F + G sin(theta - theta_0)")
        .transmitted()
        .source("Siciliano et al. 2009, section 7.3")
        .limits(
            "one link; other links at rest, unless weight_angle_rad is recorded; the angle \
             must be absolute or have the same zero in every run",
        )
        .needs(&[Need::NoFilm, Need::Angle]);
    g = "G", "N", "weight of the horizontal link, as a force at the radius",
        [0.0, 1e7], [1.0] null(0.0);
    theta_0_rad = "theta_0_rad", "rad", "angle at which the link hangs down",
        [-4.0 * PI, 4.0 * PI], [0.0, FRAC_PI_2, PI, -FRAC_PI_2] .period(TAU).signed();
}

impl<T: Real> Gravity<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            weight_n: p.g,
            cos_offset: p.theta_0_rad.cos(),
            sin_offset: p.theta_0_rad.sin(),
        }
    }
}

impl<T: Real> Effect<T> for Gravity<T> {
    type State = ();

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}

    #[inline(always)]
    fn add_friction(
        &self,
        _state: &(),
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let theta = journal.angle_rad + journal.weight_offset_rad;
        // sin(theta - theta_0) from the precomputed cosine and sine of the offset.
        let level = theta.sin() * self.cos_offset - theta.cos() * self.sin_offset;
        let force_n = self.weight_n * level;
        sum_n.smooth += force_n;
        *transmitted_n += force_n;
    }
}
