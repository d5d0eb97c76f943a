//! Friction compensators, one per file.
//!
//! A compensator estimates the friction of a shaft. It returns the voltage that cancels the
//! friction, to be added to the output of a control law. The type of a compensator contains its
//! configuration, and its `State` the variables.
//!
//! | compensator | requires | suitable for |
//! | --- | --- | --- |
//! | [`Observed`] | a friction model, the inertia | most loops: an observer corrects the error of the model |
//! | [`Coulomb`] | the inertia | an unknown friction level in motion without long rests |
//! | [`Table`] | the friction at each speed or angle | friction that does not depend on the past |
//! | [`Repetitive`] | a motion of constant period | friction that repeats with the motion |
//! | [`Learning`] | a journal bearing | reproduction of the programs of Cohn (1998) |
//!
//! A chain alone is a feedforward: the [first page](crate#a-velocity-loop-with-friction-compensation)
//! adds its friction at the reference velocity.
//!
//! # Units
//! The output is called a voltage (names that end in `_v`), as for a motor with a voltage amplifier:
//! `v' = -a v + b (u - F)`. For a drive with a torque controller, read N m for V. The input gain `b`
//! is then the inverse of the inertia and the damping `a` is zero, because the friction model
//! contains the viscous friction. One newton at a radius of 1 m is 1 N m: `volts_per_n` is 1. For a
//! linear axis, read m for rad, N for V, and the mass for the inertia.
//!
//! The constructors of friction models require a load, which laws in newtons do not use.
//!
//! # In a loop of your own
//! [`Controller`](crate::controller::Controller) is a complete loop, from the counter to the
//! voltage. Any other loop calls these methods at each sample:
//!
//! 1. [`Compensator::observe`] with the rotation since the last sample, and the output that was
//!    applied during it, after all limits;
//! 2. its own control law, with the velocity that `observe` returns;
//! 3. [`Compensator::step`], whose `sum_v` is added to the output of the control law;
//! 4. the limit of the output. While the output is limited, [`Input::may_learn`] is false.
//!
//! The example is a PI velocity loop with a torque-controlled motor and an encoder. The model has an
//! error of 25 % in all levels. The plant at the end of the loop is to be replaced by the drive.
//!
//! ```
//! use jbf_core::compensator::observed::Settings;
//! use jbf_core::compensator::{ChainModel, Compensator, Input, Observed};
//! use jbf_core::law::lugre::{LuGre, Parameters};
//! use jbf_core::plant::{Drive, Plant};
//! use jbf_core::Chain;
//!
//! const DT_S: f64 = 1e-3;
//! let drive = Drive::new(0.0, 1.0 / 0.005).with_volts_per_n(1.0).with_limit_v(3.0); // 0.005 kg m^2
//! let truth = Parameters { f_c: 0.4_f64, f_s: 0.6, v_s: 0.2, sigma_0: 400.0, sigma_1: 0.1, f_v: 0.02, v_d: 0.1 };
//! let identified = Parameters { f_c: 0.3, f_s: 0.45, ..truth };
//! let model = ChainModel::new(Chain::new(LuGre::new(identified)?), drive.volts_per_n, 1.0);
//! let settings = Settings::new(&drive, 0.12 / DT_S, 0.05, DT_S)
//!     .with_learning_1_s(4.0)
//!     .with_level_limit_v(0.5)
//!     .with_rest_limit_v(0.8);
//! let compensator = Observed::new(model, &settings)?;
//!
//! let mut rms_rad_s = [0.0_f64; 2];
//! for (compensated, rms) in [false, true].into_iter().zip(&mut rms_rad_s) {
//!     let plant = Plant::new(Chain::new(LuGre::new(truth)?), drive, DT_S)?;
//!     let (mut shaft, mut state) = (plant.start(1.0, 0.0), compensator.start());
//!     let (mut integral, mut applied, mut last_rad) = (0.0, 0.0, 0.0);
//!     for sample in 0..10_000 {
//!         let phase_rad = 3.0 * DT_S * f64::from(sample);
//!         let (target, rate) = (phase_rad.sin(), 3.0 * phase_rad.cos());
//!         let angle_rad = (shaft.angle_rad * 1e4).round() / 1e4; // read your encoder
//!         let moved_rad = angle_rad - last_rad;
//!         last_rad = angle_rad;
//!         let velocity = compensator.observe(&mut state, moved_rad / DT_S, moved_rad, applied, false);
//!         let error = velocity - target;
//!         integral -= 2.0 * error * DT_S;
//!         let base = integral - 0.2 * error;
//!         let input = Input {
//!             angle_rad,
//!             velocity_rad_s: velocity,
//!             error,
//!             reference_rad_s: target,
//!             reference_rad_s2: rate,
//!             base_v: base,
//!             may_learn: applied.abs() < drive.limit_v,
//!         };
//!         let output = compensator.step(&mut state, &input);
//!         let sum = if compensated { base + output.sum_v } else { base };
//!         applied = sum.clamp(-drive.limit_v, drive.limit_v);
//!         plant.step(&mut shaft, applied, 1.0); // command your drive
//!         *rms += (shaft.speed_rad_s - target).powi(2) / 10_000.0;
//!     }
//!     *rms = rms.sqrt();
//! }
//! assert!(rms_rad_s[1] < 0.2 * rms_rad_s[0], "{rms_rad_s:?}");
//! # Ok::<(), jbf_core::Error>(())
//! ```

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
pub struct Input<T> {
    /// Angle of the shaft since the start of the loop, rad.
    pub angle_rad: T,
    /// Speed of the shaft as [`Compensator::observe`] returned it, rad/s.
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

    /// Returns the speed estimate for the loop, rad/s; called at each sample before the control law.
    ///
    /// A compensator with its own observer ([`Observed`]) returns the estimate of the observer. Any
    /// other returns `velocity_rad_s`, the estimate of the caller. `moved_rad` is the rotation of the
    /// shaft since the previous sample, and `applied_v` the voltage that was applied during it,
    /// compensation and limit included. While `blind` is true, the encoder is considered faulty and
    /// `moved_rad` is ignored.
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

    /// Returns the output of the compensator for this sample and updates its state; called after
    /// [`Compensator::observe`] and the control law.
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
