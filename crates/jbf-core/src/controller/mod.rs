//! Control loop: encoder, velocity observer, control law, compensator, output limit, and the
//! fallback for a saturated output or a faulty encoder.
//!
//! A step does not allocate, cannot panic, and returns a finite voltage for every input. While the
//! encoder is considered faulty, or after the output has been at its limit for longer than
//! `patience_s`, nothing is learned. The control law then acts alone ([`Status::FALLBACK`]).
//!
//! The example is a loop of 2 ms with a LuGre model, corrected by an observer, in `f32` as on a
//! microcontroller:
//!
//! ```
//! use jbf_core::compensator::{observed::Settings, LawModel, Observed};
//! use jbf_core::controller::{BaseLaw, Controller, Limits, Status};
//! use jbf_core::encoder::Encoder;
//! use jbf_core::law::lugre::{LuGre, Parameters};
//! use jbf_core::observer::VelocityObserver;
//! use jbf_core::plant::Drive;
//! use jbf_core::reference::Target;
//!
//! # fn main() -> Result<(), jbf_core::Error> {
//! const DT_S: f64 = 0.002;
//! // v' = -135 v + 457 u without friction; 0.05 V are needed against a friction of 1 N m.
//! let drive = Drive::new(135.0, 457.0).with_volts_per_n(0.05).with_limit_v(10.0);
//! let friction = LuGre::new(Parameters { f_c: 4.0_f32, f_s: 6.0, ..Parameters::default() })?;
//! let model = LawModel::new(friction, 1.0, drive.volts_per_n, 1.0);
//! let law = BaseLaw::velocity(&drive);
//! let settings = Settings::new(&drive, 60.0, 0.05, DT_S)
//!     .with_learning_1_s(2.0)
//!     .with_level_limit_v(0.3)
//!     .with_rest_limit_v(1.3)
//!     .with_control_law(&law, 30.0);
//! let controller = Controller::new(
//!     Encoder::new(2387.3, 16, drive.top_speed_rad_s(), DT_S)?,
//!     VelocityObserver::new(15.0, DT_S)?,
//!     law.cast(),
//!     Observed::new(model, &settings)?,
//!     Limits::new(drive.limit_v).with_moving_v(1.9).with_patience_s(0.1),
//!     DT_S,
//! )?;
//! let mut state = controller.start();
//! // In the timer interrupt: counter in, voltage out, signals for the log.
//! let (counter, target) = (0_u32, Target { value: 1.0, rate: 0.0 });
//! let signals = controller.step(&mut state, counter, &target);
//! assert!(signals.output_v > 1.0 && signals.output_v <= 10.0);
//! assert_eq!(signals.status, Status::OK);
//! # Ok(())
//! # }
//! ```

mod fault;
mod limits;
mod signals;
mod status;

pub use crate::control_law::BaseLaw;
pub use limits::Limits;
pub use signals::Signals;
pub use status::Status;

use crate::compensator::{Compensator, Input};
use crate::encoder::{self, Encoder};
use crate::error::{positive, Error};
use crate::observer::VelocityObserver;
use crate::real::Real;
use crate::reference::Target;
use fault::FaultDetector;

/// Largest time limit, in steps; repeated doubling of the time must not overflow.
const MOST_STEPS: f64 = 1e7;

/// Control loop with encoder, velocity observer, control law and compensator.
#[derive(Clone, Copy, Debug)]
pub struct Controller<T, C> {
    /// Friction compensator.
    pub compensator: C,
    encoder: Encoder<T>,
    observer: VelocityObserver<T>,
    law: BaseLaw<T>,
    fault: FaultDetector<T>,
    limit_v: T,
}

/// State of a control loop.
#[derive(Clone, Copy, Debug)]
pub struct State<T, S> {
    /// State of the compensator.
    pub compensator: S,
    encoder: encoder::State,
    fault: fault::State,
    velocity_rad_s: T,
    target: Target<T>,
    applied_v: T,
    limited: u32,
}

impl<T: Real, C: Compensator<T>> Controller<T, C> {
    /// Creates a control loop from its components.
    ///
    /// # Errors
    /// Reports the name of the limit that is not positive and finite.
    pub fn new(
        encoder: Encoder<T>,
        observer: VelocityObserver<T>,
        law: BaseLaw<T>,
        compensator: C,
        limits: Limits,
        dt_s: f64,
    ) -> Result<Self, Error> {
        let limits = limits.checked()?;
        positive("dt_s", dt_s)?;
        let patience = libm::ceil(limits.patience_s / dt_s).clamp(1.0, MOST_STEPS) as u32;
        Ok(Self {
            compensator,
            encoder,
            observer,
            law,
            fault: FaultDetector {
                moving_v: T::of(limits.moving_v),
                patience,
            },
            limit_v: T::of(limits.output_v),
        })
    }

    /// Returns the state of a loop at rest, with the initial values of its compensator, also for a
    /// reset.
    ///
    /// Angles are relative to that of the first sample.
    #[must_use]
    pub fn start(&self) -> State<T, C::State> {
        State {
            compensator: self.compensator.start(),
            encoder: encoder::State::default(),
            fault: fault::State::default(),
            velocity_rad_s: T::ZERO,
            target: Target {
                value: T::ZERO,
                rate: T::ZERO,
            },
            applied_v: T::ZERO,
            limited: 0,
        }
    }

    /// Computes one step of the loop: returns the output voltage and its components for a counter
    /// value and a target.
    #[inline]
    #[must_use = "the voltage of this step is in the returned signals"]
    pub fn step(
        &self,
        state: &mut State<T, C::State>,
        counter: u32,
        target: &Target<T>,
    ) -> Signals<T> {
        let mut status = Status::OK;
        if target.value.is_finite() && target.rate.is_finite() {
            state.target = *target;
        } else {
            state.target.rate = T::ZERO;
            status |= Status::NOT_FINITE;
        }
        let sample = self.encoder.step(&mut state.encoder, counter);
        let doubted = self.compensator.infers_fault(&state.compensator);
        let (mut status, blind) =
            self.fault
                .step(&mut state.fault, &sample, state.applied_v, doubted, status);
        let measured = self
            .observer
            .correct(state.velocity_rad_s, sample.moved_rad);
        let angle_rad = self.encoder.angle_rad(&state.encoder);
        let v = self.compensator.observe(
            &mut state.compensator,
            measured,
            sample.moved_rad,
            state.applied_v,
            blind,
        );
        let error = self.law.error(&state.target, angle_rad, v);
        let base_v = self.law.output_v(&state.target, angle_rad, v);
        let [reference_rad_s, reference_rad_s2] = self.law.reference(&state.target);
        let answer = self.compensator.step(
            &mut state.compensator,
            &Input {
                angle_rad,
                velocity_rad_s: v,
                error,
                reference_rad_s,
                reference_rad_s2,
                base_v,
                may_learn: !blind && state.limited == 0,
            },
        );
        let alone = blind || state.limited >= self.fault.patience || !answer.sum_v.is_finite();
        let whole = base_v + if alone { T::ZERO } else { answer.sum_v };
        if alone {
            status |= Status::FALLBACK;
        }
        let output_v = if whole.is_finite() {
            whole.max(-self.limit_v).min(self.limit_v)
        } else {
            T::ZERO
        };
        // Compensation that would saturate again keeps the loop in its fallback.
        let asked = base_v + answer.sum_v;
        if asked.abs() > self.limit_v {
            status |= Status::SATURATED;
            state.limited = state.limited.saturating_add(1);
        } else {
            state.limited = 0;
        }
        let predicted = self.observer.predict(measured, base_v);
        state.velocity_rad_s = if predicted.is_finite() {
            predicted
        } else {
            T::ZERO
        };
        state.applied_v = output_v;
        Signals {
            angle_rad,
            velocity_rad_s: v,
            error,
            base_v,
            compensation: answer,
            output_v,
            status,
        }
    }
}
