//! Effects that a machine and its sensors add to a friction law, one per file.
//!
//! Each effect acts at one stage of the signal chain, from the commanded motion to the measured
//! force:
//!
//! ```text
//! commanded motion -> drive -> lubricant -> load -> film (the law)
//!                  -> contact -> transmission -> bristle -> other -> instrument
//! ```
//!
//! The *journal* is the surface at which the friction acts: a shaft in its bearing, or a slide. Its
//! motion equals the commanded motion unless the drive is compliant or has backlash.
//!
//! Each module has the type of an effect, and the struct `Parameters` from which its `new` creates the
//! effect. [`Chain::with`](crate::Chain::with) adds it to a law.
//!
//! An effect that is not in this list implements [`Effect`] with the methods of its stage;
//! [`examples/user_effect.rs`] is a complete one. The other items of this module serve programs that
//! select effects by name at run time: [`Effects::set`] creates an effect from a list of values, and
//! [`CATALOGUE`] describes the effects and their parameters.
//!
//! [`examples/user_effect.rs`]: https://github.com/jbf-friction/jbf/blob/main/crates/jbf-core/examples/user_effect.rs

// To add an effect, write its file with `described!` and `Effect`, declare the module below, and add
// the effect to the line of its stage in `catalogue.rs`.

pub mod backlash;
pub mod cogging;
pub mod cogging_2;
pub mod coulomb_drag;
pub mod direction_asymmetry;
pub mod drive_compliance;
pub mod dry_asymmetry;
pub mod dry_load_dependence;
pub mod dry_temperature_dependence;
pub mod dwell_stiction;
pub mod film_memory;
pub mod gravity;
pub mod inertia;
pub mod load_dependence;
pub mod pitch_ripple;
pub mod pitch_ripple_2;
pub mod position_ripple;
pub mod presliding;
pub mod quadratic_drag;
pub mod running_in;
pub mod sensor_drift;
pub mod sensor_hysteresis;
pub mod sensor_lag;
pub mod sensor_nonlinearity;
pub mod sensor_offset;
pub mod shear_thinning;
pub mod spring;
pub mod stribeck_asymmetry;
pub mod stribeck_excess;
pub mod stroke_dependence;
pub mod thermal_thinning;
pub mod time_delay;
pub mod torque_proportional;
pub mod viscous_asymmetry;
pub mod viscous_load_dependence;
pub mod viscous_temperature_dependence;
pub mod viscous_thinning;
pub mod vogel_viscosity;
pub mod warm_up;
pub mod zero_load_dependence;

pub(crate) mod catalogue;
mod compose;
mod info;
mod need;
mod pitch;
mod registry;
mod stage;
mod vogel;

pub use crate::parameter::{Mirror, Parameter};
pub use catalogue::{Effects, States, CATALOGUE};
pub use info::{Info, Named, Stage};
pub use need::Need;
pub use stage::{Effect, Resistance, Signal};

use crate::bearing::Bearing;
use crate::real::Real;

/// Properties of the rig that effects need.
#[derive(Clone, Copy, Debug)]
pub struct Rig<T> {
    /// Journal radius, m; 1 for a linear axis.
    pub radius_m: T,
    /// Number of bearings on the shaft.
    pub count: T,
    /// Whether the recorded force is that of the drive, ahead of its spring or gap, such as the
    /// torque of a motor. Otherwise a load cell measures the friction of the journal.
    pub force_at_drive: bool,
}

impl<T: Real> Default for Rig<T> {
    /// Returns the properties of a linear axis with one sliding surface.
    fn default() -> Self {
        Self::on(None)
    }
}

impl<T: Real> Rig<T> {
    /// Creates the properties of a rig from its bearing.
    ///
    /// Without a bearing, the axis is linear and treated as a shaft of radius 1 m. Its force counts
    /// as that of a drive, since a sensor next to the sliding surface has no inertia of the drive.
    pub(crate) fn on(bearing: Option<&Bearing>) -> Self {
        Self {
            radius_m: T::of(bearing.map_or(1.0, |b| b.radius_m)),
            count: T::of(bearing.map_or(1.0, |b| f64::from(b.count))),
            force_at_drive: bearing.is_none(),
        }
    }
}
