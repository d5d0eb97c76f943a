//! Friction laws, one a file. A law turns motion into a friction coefficient; what a rig
//! adds to it belongs to [`crate::effect`].
//!
//! Laws in newtons (all but those of a bearing) press with 1 N, so that their coefficient is
//! a force.
//!
//! To add one: write its file with [`Law`], [`Named`] and [`SteadyCurve`], name the file below,
//! and name the law in `laws!`.

pub mod coulomb;
pub mod dahl;
pub mod elasto_plastic;
pub mod journal;
pub mod journal_full;
pub mod lugre;
pub mod maxwell_slip;
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

/// A friction law: configuration here, what changes in `State`.
pub trait Law<T: Real> {
    /// What the law remembers.
    type State: Copy + Send + 'static;

    /// False where friction at a sample depends on the last step before it alone, however long that
    /// step is.
    const HAS_MEMORY: bool = core::mem::size_of::<Self::State>() > 0;

    /// True where the law bends before it slides: [`Law::bend`] then takes the place of the
    /// sign of the motion.
    const HAS_BRISTLE: bool = false;

    /// True where a contact that bends before it slides bends under all of the friction; false
    /// where the viscous part acts beside it, as it does beside a law's own bristle.
    const BENDS_WHOLE: bool = !Self::HAS_BRISTLE;

    /// So many steps from sample to sample are enough, however far apart the samples are: a law whose
    /// stepper is stable at any step goes on a straight line between them, and of more than the line
    /// no record tells. Infinite where a step that is too long loses its way.
    const ENOUGH_STEPS: f64 = f64::INFINITY;

    /// The two parameters, by their numbers on the law's page, on which the path of its film
    /// depends, where friction is told no more of the film than [`Law::film`]; see
    /// [`crate::film_path`].
    const FILM_PARAMETERS: Option<[usize; 2]> = None;

    /// What friction is told of the film.
    #[inline(always)]
    fn film(&self, state: &Self::State) -> T {
        let _ = state;
        T::ZERO
    }

    /// Put the film where [`Law::film`] said it was.
    #[inline(always)]
    fn put_film(&self, state: &mut Self::State, film: T) {
        let _ = (state, film);
    }

    /// The state at which every run starts.
    fn start(&self, load_n: T) -> Self::State;

    /// The load (N) that the law computes with, and that its coefficient refers to: a law
    /// may have a lightest one.
    fn pressed_n(&self, load_n: T) -> T {
        load_n.max(T::ZERO)
    }

    /// A load as a share of the one that the law was built with; one for a law that asks for
    /// no load.
    fn load_share(&self, load_n: T) -> T {
        let _ = load_n;
        T::ONE
    }

    /// The same law with its parameters scaled; none of a law that has no such parameters.
    fn scaled(&self, scales: &Scales<T>) -> Option<Self>
    where
        Self: Sized,
    {
        let _ = scales;
        None
    }

    /// Take a new load; cheap when it did not change.
    fn set_load(&self, state: &mut Self::State, load_n: T);

    /// Coefficient of friction now, at the film speed `velocity_m_s` (signed).
    fn friction(&self, state: &Self::State, velocity_m_s: T) -> Friction<T>;

    /// Longest step, s, that the law's own stepper takes without loss up to a speed.
    fn longest_step_s(&self, top_speed_m_s: f64) -> f64;

    /// Advance by `dt_s`; `speed_m_s` is |U| at the start, middle and end of the step, and
    /// `rate` a factor on the law's own clock.
    fn advance(&self, state: &mut Self::State, speed_m_s: [T; 3], rate: T, dt_s: T);

    /// For laws with [`Law::HAS_BRISTLE`]: bend the bristle along the motion of a step and give
    /// its coefficient, signed, without the viscous part. `level` is [`Friction::jump`] at both
    /// ends of the step, contact effects included. A step of no length is the start of a run:
    /// the bristle is then bent already where the run starts in motion.
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
}

/// True where the catalogue has a law of that name, and the values are as many as its parameters and
/// each within its bounds. A constant can be checked by it while a program is compiled; what
/// `jbf export` writes is.
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
