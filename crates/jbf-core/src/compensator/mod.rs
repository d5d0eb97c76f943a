//! Friction compensators, one per file.
//!
//! A compensator computes the voltage that cancels friction from the signals of the control loop.
//! The compensator contains the configuration, and `State` the variables. [`crate::controller`]
//! runs a compensator in a loop.

mod coulomb;
pub mod learning;
mod model;
pub mod observed;
pub mod repetitive;
mod table;

pub use coulomb::Coulomb;
pub use learning::Learning;
pub use model::{ChainModel, FrictionModel, LawModel};
pub use observed::Observed;
pub use repetitive::Repetitive;
pub use table::{Axis, Table};

use crate::real::Real;

/// Inputs of a compensator at each step.
#[derive(Clone, Copy, Debug, Default)]
#[non_exhaustive]
pub struct Input<T> {
    /// Angle since the start of the loop, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// Control error: controlled quantity minus its reference, rad or rad/s.
    pub error: T,
    /// Reference speed, rad/s.
    pub reference_rad_s: T,
    /// Reference acceleration, rad/s^2; zero where it is unknown.
    pub reference_rad_s2: T,
    /// Output of the control law before compensation, V.
    pub base_v: T,
    /// False while the output is saturated or the encoder is considered faulty; the compensator
    /// must not learn then.
    pub may_learn: bool,
}

/// Output of a compensator, with its components for logging.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Output<T> {
    /// Voltage that is added to the output of the control law, V.
    pub sum_v: T,
    /// Estimated friction, with the sign of the motion, V.
    pub friction_v: T,
    /// Part of the estimated friction that an observer adds to the prediction of a model, V.
    pub correction_v: T,
    /// Voltage that does not compensate friction: feedforward of the reference motion, V.
    pub forward_v: T,
    /// Up to two learned values; their meaning depends on the compensator.
    pub learned: [T; 2],
}

impl<T: Real> Output<T> {
    /// Creates an output of zero.
    #[must_use]
    pub(crate) fn zero() -> Self {
        Self {
            sum_v: T::ZERO,
            friction_v: T::ZERO,
            correction_v: T::ZERO,
            forward_v: T::ZERO,
            learned: [T::ZERO; 2],
        }
    }

    /// Creates an output that consists of the estimated friction (V) only, with the learned values
    /// for logging.
    #[inline]
    #[must_use]
    pub fn of(friction_v: T, learned: [T; 2]) -> Self {
        Self {
            sum_v: friction_v,
            friction_v,
            learned,
            ..Self::zero()
        }
    }

    /// Converts to another number type.
    #[must_use]
    pub fn cast<U: Real>(&self) -> Output<U> {
        let cast = |value: T| U::of(value.value());
        Output {
            sum_v: cast(self.sum_v),
            friction_v: cast(self.friction_v),
            correction_v: cast(self.correction_v),
            forward_v: cast(self.forward_v),
            learned: self.learned.map(cast),
        }
    }
}

/// A friction compensator.
pub trait Compensator<T: Real> {
    /// State of the compensator.
    type State: Copy;

    /// Returns the state at the start of a run, also for a reset.
    fn start(&self) -> Self::State;

    /// Returns the speed estimate for the loop, rad/s.
    ///
    /// The default returns `velocity_rad_s`, the estimate of the loop; a compensator with its own
    /// observer returns that of the observer. `moved_rad` is the rotation of the shaft since the
    /// previous step, and `applied_v` the voltage during it. `blind` is true while the encoder is
    /// considered faulty.
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

    /// Returns true if the compensator's observer infers that the shaft turned without a count.
    ///
    /// The encoder is then considered faulty. The default is false.
    #[inline]
    fn infers_fault(&self, state: &Self::State) -> bool {
        let _ = state;
        false
    }

    /// Computes the output of the compensator for one step and updates its state.
    #[must_use]
    fn step(&self, state: &mut Self::State, input: &Input<T>) -> Output<T>;
}

/// No compensation: the control law acts alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoCompensation;

impl<T: Real> Compensator<T> for NoCompensation {
    type State = ();

    fn start(&self) {}

    #[inline]
    fn step(&self, _state: &mut (), _input: &Input<T>) -> Output<T> {
        Output::zero()
    }
}
