//! What a rig adds between the commanded motion and the recorded friction, one effect a
//! file, each at one stage of the signal chain:
//!
//! ```text
//! commanded motion -> drive -> lubricant -> load -> film (the law) -> contact -> other -> instrument
//! ```
//!
//! An effect knows its own stage and nothing of the others. To add one: write its file
//! and name it in its stage's line of `signal_chain!` below.

pub mod info;
mod need;
pub mod own;
mod registry;

pub use crate::law::Scales;
pub use crate::page::Parameter;
pub use info::{Info, Stage};
pub use need::Need;
use own::{Nothing, Own};

use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::page::{same, values_fit};
use crate::real::Real;

/// What every effect has: a page in the catalogue, a checked constructor, a state.
pub trait Effect<T: Real>: Copy {
    /// The page in the catalogue.
    const INFO: Info;
    /// True where a parameter moves the instants at which friction jumps: no fit may lean on the
    /// samples next to such a jump.
    const MOVES_JUMPS: bool = false;
    /// A parameter along which the likelihood of a record has peak beside peak: a fit looks for
    /// higher ones.
    const PEAKS: Option<&'static str> = None;
    /// What the effect remembers; `()` for most.
    type State: Copy;

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

/// What holds the journal back, as the drive feels it: `level sgn(v) + slope v`, N a bearing.
///
/// A line over the speed, not [`Friction`] at one: a drive solves for the speed that the journal
/// will have, and must know what friction is at another than now.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<T> {
    /// Largest force that takes the sign of the motion, N.
    pub level_n: T,
    /// Slope of the part that grows with speed, N s/m.
    pub slope_n_s_m: T,
}

impl<T: Real> Resistance<T> {
    /// No resistance.
    pub(crate) const NONE: Self = Self {
        level_n: T::ZERO,
        slope_n_s_m: T::ZERO,
    };

    /// On a straight line through `before` and this, `share` of a step further.
    #[inline(always)]
    pub(crate) fn ahead(&self, before: &Self, share: f64) -> Self {
        let on = |a: T, b: T| (b + (b - a) * T::of(share)).max(T::ZERO);
        Self {
            level_n: on(before.level_n, self.level_n),
            slope_n_s_m: on(before.slope_n_s_m, self.slope_n_s_m),
        }
    }
}

/// Between the encoder and the journal.
pub trait Drive<T: Real>: Effect<T> {
    /// Advance over `dt_s`, the motion that drives going to `to`, and give the motion that is
    /// passed on. `resistance` is that in the middle of the step and at its end.
    fn step(
        &self,
        state: &mut Self::State,
        to: &JournalMotion<T>,
        resistance: &[Resistance<T>; 2],
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T>;
    /// The force that the commanded side feels where it is not the journal's friction, as a force
    /// on one bearing, N.
    #[inline(always)]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }
}

/// Changes the law's own parameters with the load.
pub trait Loading<T: Real>: Effect<T> {
    /// Factors under a load of `share` times the rig's; all one where `share` is one.
    fn scales(&self, state: &mut Self::State, share: T) -> Scales<T>;
}

/// Changes the speed that the film feels (its viscosity).
pub trait Lubricant<T: Real>: Effect<T> {
    /// Factor on `Ub`.
    fn factor(&self, state: &Self::State, journal: &JournalMotion<T>) -> T;
    /// Advance over `dt_s`, the friction power (W) going from the first to the second value.
    fn step(&self, state: &mut Self::State, power_w: [T; 2], dt_s: T);
}

/// Changes how fast the film follows.
pub trait Film<T: Real>: Effect<T> {
    /// Factor on the film's clock.
    fn rate(&self, state: &Self::State) -> T;
    /// The largest that factor will be, at least one.
    fn fastest(&self) -> f64;
}

/// Changes the friction between the surfaces.
pub trait Contact<T: Real>: Effect<T> {
    /// Change the sliding friction.
    fn apply(&self, state: &Self::State, journal: &JournalMotion<T>, sliding: &mut Friction<T>);
    /// Advance over `dt_s` before `apply`.
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        dt_s: T,
    );
}

/// Replaces the sign of the motion by a deflection: the last step of the contact stage.
pub trait Bristle<T: Real>: Effect<T> {
    /// The coefficient at the start of a run: bent already where the run starts in motion.
    fn first(&self, state: &mut Self::State, journal: &JournalMotion<T>, magnitude: T) -> T;
    /// Advance over `dt_s`; the sliding coefficient goes from the first magnitude to the
    /// second. Gives the coefficient, signed.
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> T;
}

/// Friction that is not the bearing's.
pub trait OtherFriction<T: Real>: Effect<T> {
    /// The friction, N.
    fn friction_n(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T>;
}

/// The force during a step, as an instrument meets it.
///
/// Friction jumps where a rigid journal starts, stops or turns; what it is on the inside of the
/// step differs there from what it is at the sample, and an instrument with a memory must follow
/// the inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal<T> {
    /// Just after the beginning of the step, N.
    pub begin_n: T,
    /// Just before its end, N.
    pub end_n: T,
    /// At its end, N.
    pub now_n: T,
}

impl<T: Real> Signal<T> {
    /// The signal with a constant added.
    #[inline]
    pub fn shifted(self, by_n: T) -> Self {
        Self {
            begin_n: self.begin_n + by_n,
            end_n: self.end_n + by_n,
            now_n: self.now_n + by_n,
        }
    }
}

/// Between the force and its record.
pub trait Instrument<T: Real>: Effect<T> {
    /// The first reading of a run that begins with `force_n`.
    fn first(&self, state: &mut Self::State, force_n: T) -> T;
    /// What the instrument makes of the signal of a step of `dt_s` that ends at `time_s`.
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T>;
}

// The fixed order of the chain, in one place; inside a stage effects act from left to right.
registry::signal_chain! {
    drive: [drive_compliance::DriveCompliance, backlash::Backlash],
    lubricant: [shear_thinning::ShearThinning, thermal_thinning::ThermalThinning],
    load: [load_dependence::LoadDependence],
    film: [film_memory::FilmMemory],
    contact: [
        wear_in::WearIn,
        dwell_stiction::DwellStiction,
        stribeck_excess::StribeckExcess,
        direction_asymmetry::DirectionAsymmetry,
        position_ripple::PositionRipple,
    ],
    bristle: [presliding::Presliding],
    other: [
        coulomb_drag::CoulombDrag,
        quadratic_drag::QuadraticDrag,
        inertia_leak::InertiaLeak,
    ],
    instrument: [
        sensor_lag::SensorLag,
        time_delay::TimeDelay,
        sensor_offset::SensorOffset,
        sensor_drift::SensorDrift,
    ],
}

/// True where the catalogue has an effect of that name, and the values are as many as its parameters and
/// each within its bounds. A constant can be checked by it while a program is compiled; what
/// `jbf export` writes is.
///
/// ```
/// const _: () = assert!(jbf_core::effect::fits("coulomb_drag", &[0.8]));
/// ```
pub const fn fits(name: &str, values: &[f64]) -> bool {
    let mut i = 0;
    while i < CATALOGUE.len() {
        if same(CATALOGUE[i].name, name) {
            return values_fit(CATALOGUE[i].parameters, values);
        }
        i += 1;
    }
    false
}
