//! Effects between the commanded motion and the recorded friction, one per file.
//!
//! Each effect acts at one stage of the signal chain:
//!
//! ```text
//! commanded motion -> drive -> lubricant -> load -> film (the law)
//!                  -> contact -> other -> instrument
//! ```
//!
//! An effect is independent of the other stages. To add an effect, write its file, declare the
//! module below, and add the effect to the line of its stage in `catalogue.rs`.

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

mod catalogue;
mod compose;
mod info;
mod need;
mod pitch;
pub mod place;
mod registry;
pub mod set;
mod stage;
mod vogel;

pub use crate::law::Scales;
pub use crate::page::Parameter;
pub use catalogue::{
    fits, moves_jumps, peaks, spreads_jumps, type_names, Effects, OccupiedStages, States, CATALOGUE,
};
pub use info::{Info, Stage};
pub use need::Need;
pub use place::{
    AsBristle, Beside, InContact, InDrive, InFilm, InInstrument, InLubricant, InTransmission,
    Place, UnderLoad,
};
pub use set::EffectSet;
pub use stage::{
    Bristle, Contact, Drive, Film, Instrument, Loading, Lubricant, OtherFriction, Resistance,
    Signal, Transmission,
};

use crate::bearing::Bearing;
use crate::error::ParameterError;
use crate::motion::Motion;
use crate::real::Real;
use core::fmt::Debug;

/// Effect in a signal chain: a description for the catalogue, a constructor that checks the
/// parameters, and a state.
pub trait Effect<T: Real>: Copy + Debug {
    /// Description of the effect in the catalogue.
    const INFO: Info;
    /// True if a parameter changes the instants at which friction jumps.
    ///
    /// A fit must then exclude the samples next to such a jump.
    const MOVES_JUMPS: bool = false;
    /// True if the predicted force depends on a jump for longer than the step of the jump.
    ///
    /// An error in the instant of the jump then affects more samples than those next to it.
    const SPREADS_JUMPS: bool = false;
    /// Name of the parameter along which the likelihood may have several maxima; a fit then
    /// searches for higher ones.
    const PEAKS: Option<&'static str> = None;
    /// State of the effect in the course of a run; `()` for most effects.
    type State: Copy + Debug;

    /// Creates the effect from its parameters, in the order of `INFO.parameters`.
    ///
    /// # Errors
    /// Reports the first parameter that is missing or out of its bounds.
    fn new(parameters: &[T]) -> Result<Self, ParameterError>;

    /// Returns the state at the start of a run that begins with `motion`.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;
}

/// Properties of the rig that effects need.
#[derive(Clone, Copy, Debug)]
pub struct Rig<T> {
    /// Journal radius, m; 1 for a linear axis.
    pub radius_m: T,
    /// Number of bearings on the shaft.
    pub count: T,
}

impl<T: Real> Rig<T> {
    /// Creates the properties of a rig from its bearing.
    ///
    /// Without a bearing, the axis is linear and treated as a shaft of radius 1 m.
    pub fn on(bearing: Option<&Bearing>) -> Self {
        Self {
            radius_m: T::of(bearing.map_or(1.0, |b| b.radius_m)),
            count: T::of(bearing.map_or(1.0, |b| f64::from(b.count))),
        }
    }
}
