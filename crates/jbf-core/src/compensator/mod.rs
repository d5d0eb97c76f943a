//! Friction compensators, one per file.
//!
//! A compensator computes, from the signals of the loop, the voltage that cancels friction.
//! Configuration is in the compensator, variables are in `State`. [`crate::controller`] runs a
//! compensator in a loop.

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

/// Inputs of a compensator at each step.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Sense<T> {
    /// Angle since the start, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// Controlled quantity minus its reference, rad or rad/s.
    pub error: T,
    /// Reference speed, rad/s.
    pub wanted_rad_s: T,
    /// Reference acceleration, rad/s^2; zero where it is unknown.
    pub wanted_rad_s2: T,
    /// Output of the control law before compensation, V.
    pub base_v: T,
    /// False while the loop is saturated or blind; the compensator must not learn then.
    pub may_learn: bool,
}

/// Output of a compensator, with its parts for logging.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Answer<T> {
    /// Voltage to add to the output of the control law, V.
    pub sum_v: T,
    /// Estimated friction, with the sign of the motion, V.
    pub friction_v: T,
    /// Part of the estimated friction that an observer added to a model, V.
    pub correction_v: T,
    /// Voltage that does not compensate friction: feedforward of the reference motion, V.
    pub forward_v: T,
    /// Up to two learned values, whose meaning depends on the compensator.
    pub learned: [T; 2],
}

impl<T: Real> Answer<T> {
    /// Output of zero.
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

    /// Output that consists of the estimated friction (V) only, reported with the learned values.
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

    /// Converts to another number type.
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
    /// State of the compensator.
    type State: Copy;

    /// Returns the state at the start of a run; it also serves as the reset.
    fn start(&self) -> Self::State;

    /// Returns the speed estimate; a compensator with its own observer replaces the loop's
    /// estimate.
    ///
    /// `moved_rad` is the motion of the shaft since the previous step and `applied_v` the voltage
    /// applied during it. `blind` is true while the encoder is not trusted.
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

    /// True where the compensator's observer infers that the shaft turned without a count.
    ///
    /// The encoder is then not trusted. The default is false.
    #[inline]
    fn doubts(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// Computes the output of one step.
    #[must_use]
    fn step(&self, state: &mut Self::State, sense: &Sense<T>) -> Answer<T>;
}

/// No compensation: the control law acts alone.
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
