//! Friction laws, one per file.
//!
//! A law turns motion into a friction coefficient; the contributions of a rig belong to
//! [`crate::effect`].
//!
//! Laws in newtons (all except those of a bearing) use a load of 1 N, so that their coefficient is
//! a force.
//!
//! To add a law, write its file with [`Law`], [`Named`] and [`SteadyCurve`], declare the module
//! below, and add the law to `laws!`.

pub mod coulomb;
pub mod dahl;
pub mod elasto_plastic;
pub mod journal;
pub mod journal_full;
pub mod lugre;
pub mod maxwell_slip;
pub mod rate_and_state;
pub mod seven_parameter;
pub mod stribeck;

pub(crate) mod bristle;
pub mod info;
mod newtons;
mod registry;
mod scales;
mod steady;

pub use info::{Info, Named, SteadyCurve, Visitor};
pub use scales::Scales;
pub use steady::Steady;

use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::ParameterError;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::real::Real;

/// A friction law, which holds the configuration; variables are in `State`.
pub trait Law<T: Real> {
    /// State of the law.
    type State: Copy + Send + 'static;

    /// False if friction at a sample depends only on the last step before it, for any length of
    /// that step.
    const HAS_MEMORY: bool = core::mem::size_of::<Self::State>() > 0;

    /// True if the law deflects before it slides: [`Law::bend`] then replaces the sign of the
    /// motion.
    const HAS_BRISTLE: bool = false;

    /// True if a contact that deflects before it slides carries all of the friction.
    ///
    /// False if the viscous part acts in parallel with it, as it does with a law's own bristle.
    const BENDS_WHOLE: bool = !Self::HAS_BRISTLE;

    /// Number of steps between samples that is sufficient for any sampling interval.
    ///
    /// A law whose stepper is stable at any step follows a straight line between samples, and a
    /// record contains no more than that line. Infinite if a step that is too long diverges.
    const ENOUGH_STEPS: f64 = f64::INFINITY;

    /// Indices, in the description of the law, of the two parameters that determine the path of its
    /// film.
    ///
    /// It is set only if friction depends on the film through [`Law::film`] alone; see
    /// [`crate::film_path`].
    const FILM_PARAMETERS: Option<[usize; 2]> = None;

    /// State of the film that enters friction.
    #[inline(always)]
    fn film(&self, state: &Self::State) -> T {
        let _ = state;
        T::ZERO
    }

    /// Sets the film to a value of [`Law::film`].
    #[inline(always)]
    fn put_film(&self, state: &mut Self::State, film: T) {
        let _ = (state, film);
    }

    /// Returns the state at the start of a run.
    fn start(&self, load_n: T) -> Self::State;

    /// Load (N) that the law uses and that its coefficient refers to; a law may have a lightest
    /// load.
    fn pressed_n(&self, load_n: T) -> T {
        load_n.max(T::ZERO)
    }

    /// Load relative to the load that the law was built with; one for a law that does not depend on
    /// it.
    fn load_share(&self, load_n: T) -> T {
        let _ = load_n;
        T::ONE
    }

    /// Returns the law with scaled parameters; `None` if it has no such parameters.
    fn scaled(&self, scales: &Scales<T>) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = scales;
        None
    }

    /// Sets a new load; inexpensive when it did not change.
    fn set_load(&self, state: &mut Self::State, load_n: T);

    /// Friction coefficient at the film speed `velocity_m_s` (signed).
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Friction<T>;

    /// Longest step, s, of the law's own stepper without loss of accuracy, up to a speed.
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64;

    /// Advances by `dt_s`.
    ///
    /// `speed_m_s` is |U| at the start, middle and end of the step, and `rate` a factor on the
    /// law's own clock.
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T);

    /// Deflects the bristle along the motion of a step and returns its signed coefficient, without
    /// the viscous part.
    ///
    /// It is called for laws with [`Law::HAS_BRISTLE`]. `level` is [`Friction::jump`] at both ends
    /// of the step, including contact effects. A step of zero length is the start of a run: the
    /// bristle is then fully deflected if the run starts in motion.
    #[inline]
    fn bend(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        let _ = (state, from, dt_s);
        level[1] * to.direction
    }
}

registry::laws! {
    journal::Journal,
    journal_full::JournalFull,
    coulomb::Coulomb,
    stribeck::Stribeck,
    seven_parameter::SevenParameter,
    dahl::Dahl,
    lugre::LuGre,
    maxwell_slip::MaxwellSlip,
    elasto_plastic::ElastoPlastic,
    rate_and_state::RateAndState,
}

/// True if the catalogue has a law of this name and the values fit its parameters.
///
/// The number of values must be that of the parameters, and each value must be within its bounds.
/// The function can check a constant at compile time, such as those that `jbf export` writes.
///
/// ```
/// const _: () = assert!(jbf_core::law::fits("journal", &[0.26, 0.06, 7.5e5, 33.0]));
/// ```
pub const fn fits(name: &str, values: &[f64]) -> bool {
    let mut i = 0;
    while i < CATALOGUE.len() {
        if crate::page::same(CATALOGUE[i].name, name) {
            return crate::page::values_fit(CATALOGUE[i].parameters, values);
        }
        i += 1;
    }
    false
}
