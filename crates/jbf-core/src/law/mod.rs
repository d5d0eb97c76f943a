//! Friction laws, one per file.
//!
//! A law computes friction from the motion. Contributions of the machine are effects, see
//! [`crate::effect`]. Each module has the type of a law, and the struct `Parameters` from which its
//! `new` creates the law. A [`Chain`](crate::Chain) runs a law.
//!
//! All laws except those of a journal bearing return newtons and do not depend on the load.
//!
//! A law that is not in this list implements [`Law`]; [`examples/user_law.rs`] is a complete one. The
//! other items of this module serve programs that select a law by name at run time: [`with_law`]
//! creates it from a list of values, and [`CATALOGUE`] describes the laws and their parameters.
//!
//! [`examples/user_law.rs`]: https://github.com/jbf-friction/jbf/blob/main/crates/jbf-core/examples/user_law.rs

// To add a law, write its file with `described!`, `Law` and `SteadyCurve`, declare the module below,
// and add the law to `laws!`.

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
mod info;
mod newtons;
mod registry;
mod scales;
mod steady;

pub use info::{Info, Named, SteadyCurve, Visitor};
pub use scales::Scales;
pub use steady::Steady;

use crate::bearing::Bearing;
use crate::clock::Clock;
use crate::error::Error;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::real::Real;

/// Friction law: the type contains the parameters, and `State` the variables.
///
/// [`Law::friction`] returns a coefficient, which the chain multiplies by [`Law::pressed_n`]. A law in
/// newtons returns 1 N there, so that its coefficient is the force.
pub trait Law<T: Real> {
    /// State of the law in the course of a run.
    type State: Copy + Send + 'static;

    /// True if friction depends on motion before the last step; false if the last step, of any
    /// length, determines the friction at its end.
    const HAS_MEMORY: bool = core::mem::size_of::<Self::State>() > 0;

    /// True if the law deflects before it slides; [`Law::bend`] then replaces the jump at a
    /// reversal.
    const HAS_BRISTLE: bool = false;

    /// True if all of the friction deflects with a contact that deflects before it slides.
    ///
    /// False if viscous friction acts in parallel, as it does in a law that
    /// [deflects](Self::HAS_BRISTLE).
    const BENDS_WHOLE: bool = !Self::HAS_BRISTLE;

    /// True if friction at rest may exceed sliding friction at zero speed.
    ///
    /// Under a rigid drive, a step from rest then starts at the sliding level, which is taken from
    /// the end of the step.
    const HAS_STATIC_LEVEL: bool = false;

    /// Number of steps between two samples that is sufficient for any sampling interval.
    ///
    /// The number is finite for a law that is stable with any step, because the motion between two
    /// samples is taken as linear. It is infinite if the solution diverges with a step that is too
    /// long.
    const ENOUGH_STEPS: f64 = f64::INFINITY;

    /// Indices, in the description of the law, of the two parameters that determine the path of its
    /// film.
    ///
    /// The indices are given only if friction depends on the film through [`Law::film`] alone; see
    /// `jbf_batch::film_path`.
    #[doc(hidden)]
    const FILM_PARAMETERS: Option<[usize; 2]> = None;

    /// Returns the state of the film that determines friction.
    #[doc(hidden)]
    #[inline(always)]
    fn film(&self, state: &Self::State) -> T {
        let _ = state;
        T::ZERO
    }

    /// Sets the state of the film from a value of [`Law::film`].
    #[doc(hidden)]
    #[inline(always)]
    fn put_film(&self, state: &mut Self::State, film: T) {
        let _ = (state, film);
    }

    /// Returns the state at the start of a run under a load (N).
    fn start(&self, load_n: T) -> Self::State;

    /// Returns the load to which the coefficient refers, N; a law may have a lightest load.
    fn pressed_n(&self, load_n: T) -> T {
        load_n.max(T::ZERO)
    }

    /// Returns the load relative to that given to the constructor; one for a law that does not
    /// depend on the load.
    fn load_share(&self, load_n: T) -> T {
        let _ = load_n;
        T::ONE
    }

    /// Returns the law with scaled parameters; `None` if the law has no such parameters.
    fn scaled(&self, scales: &Scales<T>) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = scales;
        None
    }

    /// Sets a new load (N); inexpensive if the load did not change.
    fn set_load(&self, state: &mut Self::State, load_n: T);

    /// Returns the friction coefficient at the speed of the film `velocity_m_s` (signed).
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Friction<T>;

    /// Returns the longest step with which the law is accurate at speeds up to `top_speed_m_s`, s.
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64;

    /// Advances the state by `dt_s`.
    ///
    /// `speed_m_s` contains |U| at the start, middle and end of the step, and `rate` is a factor on
    /// the rate of the dynamics.
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T);

    /// Advances the deflection by a step and returns the signed friction coefficient, without
    /// viscous friction.
    ///
    /// The method is called for laws with [`Law::HAS_BRISTLE`]. `level` is [`Friction::jump`] at
    /// both ends of the step, including contact effects. A step of zero length is the start of a
    /// run: the bristle is then fully deflected if the run starts in motion.
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
