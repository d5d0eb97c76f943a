//! Friction compensators, one a file: from what the loop senses to the voltage that shall cancel
//! friction. Configuration here, what changes in `State`; [`crate::controller`] puts one into a
//! loop.

pub mod carried;
pub mod coulomb;
pub mod learning;
pub mod observed;
pub mod repetitive;
pub mod table;

pub use carried::{Bare, Carried};
pub use coulomb::Coulomb;
pub use learning::Learning;
pub use observed::Observed;
pub use repetitive::Repetitive;
pub use table::Table;

use crate::real::Real;

/// What a compensator is told at each step.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Sense<T> {
    /// Angle since the start, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// What is controlled minus its reference, rad or rad/s.
    pub error: T,
    /// Speed that the reference asks for, rad/s.
    pub wanted_rad_s: T,
    /// Acceleration that the reference asks for, rad/s^2; zero where it is not known.
    pub wanted_rad_s2: T,
    /// Output of the control law before compensation, V.
    pub base_v: T,
    /// False while the loop is saturated or blind: nothing may be learned then.
    pub may_learn: bool,
}

/// A compensator's answer, in parts for logging.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Answer<T> {
    /// Voltage to add to the control law's, V.
    pub sum_v: T,
    /// Friction that the compensator believes in, with the sign of the motion, V.
    pub friction_v: T,
    /// The part of it that an observer added to a model, V.
    pub correction_v: T,
    /// Voltage that is not friction: what the reference's motion asks for, V.
    pub forward_v: T,
    /// Up to two learned numbers; their meaning is the compensator's.
    pub learned: [T; 2],
}

impl<T: Real> Answer<T> {
    /// Nothing is sent out.
    #[must_use]
    pub fn nothing() -> Self {
        Self {
            sum_v: T::ZERO,
            friction_v: T::ZERO,
            correction_v: T::ZERO,
            forward_v: T::ZERO,
            learned: [T::ZERO; 2],
        }
    }

    /// The friction that is believed in (V) is sent out, and nothing else; what was learned is
    /// told beside it.
    #[inline]
    #[must_use]
    pub fn of(friction_v: T, learned: [T; 2]) -> Self {
        Self {
            sum_v: friction_v,
            friction_v,
            learned,
            ..Self::nothing()
        }
    }

    /// The same in another kind of number.
    #[must_use]
    pub fn lift<U: Real>(&self) -> Answer<U> {
        let lift = |value: T| U::of(value.value());
        Answer {
            sum_v: lift(self.sum_v),
            friction_v: lift(self.friction_v),
            correction_v: lift(self.correction_v),
            forward_v: lift(self.forward_v),
            learned: self.learned.map(lift),
        }
    }
}

/// A friction compensator.
pub trait Compensator<T: Real> {
    /// What changes while it runs.
    type State: Copy;

    /// The state at the start of a run. It is also the reset.
    fn start(&self) -> Self::State;

    /// A compensator with an observer of its own replaces the loop's speed estimate. `moved_rad`
    /// is the shaft's motion since the step before, `applied_v` the voltage that was applied
    /// meanwhile; `blind` where the encoder is not to be believed.
    #[inline]
    fn observe(
        &self,
        state: &mut Self::State,
        velocity_rad_s: T,
        moved_rad: T,
        applied_v: T,
        blind: bool,
    ) -> T {
        let _ = (state, moved_rad, applied_v, blind);
        velocity_rad_s
    }

    /// True where a compensator that knows rest from motion has seen the shaft turn without a
    /// count: the encoder is then not to be believed.
    #[inline]
    fn doubts(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// One step.
    #[must_use]
    fn step(&self, state: &mut Self::State, sense: &Sense<T>) -> Answer<T>;
}

/// No compensation: the control law alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCompensation;

impl<T: Real> Compensator<T> for NoCompensation {
    type State = ();

    fn start(&self) {}

    #[inline]
    fn step(&self, _state: &mut (), _sense: &Sense<T>) -> Answer<T> {
        Answer::nothing()
    }
}
