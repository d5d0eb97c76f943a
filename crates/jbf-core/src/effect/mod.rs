//! What a rig adds between the commanded motion and the recorded friction, one effect a
//! file, each at one stage of the signal chain:
//!
//! ```text
//! commanded motion -> drive -> lubricant -> load -> film (the law) -> contact -> other -> instrument
//! ```
//!
//! An effect knows its own stage and nothing of the others. To add one: write its file, name the
//! file below, and name the effect in its stage's line of `catalogue.rs`.

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
pub mod inertia_leak;
pub mod load_dependence;
pub mod pitch_ripple;
pub mod pitch_ripple_2;
pub mod position_ripple;
pub mod presliding;
pub mod quadratic_drag;
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
pub mod wear_in;
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

/// What every effect has: a page in the catalogue, a checked constructor, a state.
pub trait Effect<T: Real>: Copy + Debug {
    /// The page in the catalogue.
    const INFO: Info;
    /// True where a parameter moves the instants at which friction jumps: no fit may lean on the
    /// samples next to such a jump.
    const MOVES_JUMPS: bool = false;
    /// True where what is read of a jump lasts: an error in the jump's instant is read as long, and
    /// not in the samples next to it alone.
    const SPREADS_JUMPS: bool = false;
    /// A parameter along which the likelihood of a record has peak beside peak: a fit looks for
    /// higher ones.
    const PEAKS: Option<&'static str> = None;
    /// What the effect remembers; `()` for most.
    type State: Copy + Debug;

    /// Build from the parameters in the order of `INFO.parameters`.
    ///
    /// # Errors
    /// Names the first parameter that is missing or out of its bounds.
    fn new(parameters: &[T]) -> Result<Self, ParameterError>;

    /// The state at the start of a run that begins with `motion`.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;
}

/// The few numbers of a rig that effects need.
#[derive(Clone, Copy, Debug)]
pub struct Rig<T> {
    /// Journal radius, m.
    pub radius_m: T,
    /// Bearings on the shaft.
    pub count: T,
}

impl<T: Real> Rig<T> {
    /// That of a shaft in this bearing. Without one the axis is a linear one: a rotary one of
    /// radius 1 m.
    pub fn on(bearing: Option<&Bearing>) -> Self {
        Self {
            radius_m: T::of(bearing.map_or(1.0, |b| b.radius_m)),
            count: T::of(bearing.map_or(1.0, |b| f64::from(b.count))),
        }
    }
}
