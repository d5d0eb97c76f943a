//! The loop: encoder, velocity observer, control law, compensator, limit, and what to do when
//! the loop is saturated or blind.
//!
//! A step costs no allocation, cannot panic, and gives a finite voltage for whatever it is given.
//! Where the encoder is not to be believed, or the output has stood at its limit for longer than
//! `patience_s`, nothing is learned and the control law acts alone ([`Status::FALLBACK`]).
//!
//! A loop of 2 ms round the film model of Table 4.2, corrected by an observer, in `f32` as on a
//! microcontroller:
//!
//! ```
//! use jbf_core::compensator::{observed::Settings, Bare, Observed};
//! use jbf_core::controller::{BaseLaw, Controller, Limits, Status};
//! use jbf_core::encoder::Encoder;
//! use jbf_core::law::journal::{Journal, Parameters};
//! use jbf_core::observer::VelocityObserver;
//! use jbf_core::reference::Target;
//! use jbf_core::{Bearing, Clock};
//!
//! # fn main() -> Result<(), jbf_core::Error> {
//! const DT_S: f64 = 0.002;
//! let film = Parameters { f_m: 0.26_f32, u_tr_m_s: 0.06, k0: 7.5e5, gamma: 33.0 };
//! let model = Bare {
//!     law: Journal::new(&Bearing::THESIS, 104.0, &film, Clock::Journal)?,
//!     radius_m: 0.0127,
//!     volts_per_n: 0.0283,
//!     load_n: 104.0,
//! };
//! // What `jbf control tune model.toml` prints.
//! let settings = Settings {
//!     damping_1_s: 135.0,
//!     input_rad_s2_v: 457.0,
//!     bandwidth_rad_s: 60.0,
//!     learning_1_s: 2.0,
//!     level_limit_v: 0.76,
//!     rest_limit_v: 1.76,
//!     slow_rad_s: 0.05,
//!     approach_1_s: 0.0,
//!     breakaway: 1.0,
//!     stiffer_v_rad: 0.0,
//!     stiffer_v_s_rad: 0.0,
//!     law_forward_v_s_rad: 0.295,
//!     dt_s: DT_S,
//! };
//! let controller = Controller::new(
//!     Encoder::new(2387.3, 16, 68.0, DT_S)?,
//!     VelocityObserver::plain(15.0, DT_S)?,
//!     BaseLaw::thesis_velocity(),
//!     Observed::new(model, &settings)?,
//!     Limits { output_v: 10.0, moving_v: 1.9, patience_s: 0.1 },
//!     DT_S,
//! )?;
//! let mut state = controller.start();
//! // In the timer interrupt: counter in, voltage out, parts for the log.
//! let (counter, target) = (0_u32, Target { value: 1.0, rate: 0.0 });
//! let parts = controller.step(&mut state, counter, &target);
//! assert!(parts.output_v > 1.0 && parts.output_v <= 10.0);
//! assert_eq!(parts.status, Status::OK);
//! # Ok(())
//! # }
//! ```

mod base_law;
mod status;

pub use base_law::BaseLaw;
pub use status::Status;

use crate::compensator::{Answer, Compensator, Sense};
use crate::encoder::{self, Encoder};
use crate::error::{check, positive, Error};
use crate::observer::VelocityObserver;
use crate::real::Real;
use crate::reference::Target;

/// Longest patience, in steps: room for doubts that double.
const MOST_STEPS: f64 = 1e7;

/// A doubt lasts at most `2^this` times the patience.
const LONGEST_DOUBT: u32 = 7;

/// When a loop stops believing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest output, V.
    pub output_v: f64,
    /// A voltage that surely moves the shaft, V: a counter that stands still under it is frozen.
    pub moving_v: f64,
    /// Time after which a still counter is frozen, a limited output gives up compensation, and a
    /// loop that sees again compensates again, s.
    pub patience_s: f64,
}

/// A loop with its compensator.
#[derive(Clone, Copy, Debug)]
pub struct Controller<T, C> {
    /// The compensator.
    pub compensator: C,
    encoder: Encoder<T>,
    observer: VelocityObserver<T>,
    law: BaseLaw<T>,
    limit_v: T,
    moving_v: T,
    patience: u32,
}

/// What changes in the loop.
#[derive(Clone, Copy, Debug)]
pub struct State<T, S> {
    /// The compensator's own.
    pub compensator: S,
    encoder: encoder::State,
    velocity_rad_s: T,
    target: Target<T>,
    applied_v: T,
    pushed: u32,
    doubt: u32,
    doubts: u32,
    limited: u32,
    blind: u32,
}

/// Everything about one step, for logging.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Parts<T> {
    /// Angle since the start, rad.
    pub angle_rad: T,
    /// Speed estimate, rad/s.
    pub velocity_rad_s: T,
    /// What is controlled minus its reference, rad or rad/s.
    pub error: T,
    /// The control law's share, V.
    pub base_v: T,
    /// The compensator's share and its parts.
    pub compensation: Answer<T>,
    /// What goes to the amplifier, V: finite, within the limit.
    pub output_v: T,
    /// How the loop is.
    pub status: Status,
}

impl<T: Real, C: Compensator<T>> Controller<T, C> {
    /// Put a loop together.
    ///
    /// # Errors
    /// Names the limit that is not positive and finite.
    pub fn new(
        encoder: Encoder<T>,
        observer: VelocityObserver<T>,
        law: BaseLaw<T>,
        compensator: C,
        limits: Limits,
        dt_s: f64,
    ) -> Result<Self, Error> {
        positive("output_v", limits.output_v)?;
        positive("moving_v", limits.moving_v)?;
        positive("dt_s", dt_s)?;
        check(
            limits.patience_s >= 0.0 && limits.patience_s < 1e6,
            "patience_s",
            limits.patience_s,
            "must be zero or positive, and below 1e6",
        )?;
        Ok(Self {
            compensator,
            encoder,
            observer,
            law,
            limit_v: T::of(limits.output_v),
            moving_v: T::of(limits.moving_v),
            patience: libm::ceil(limits.patience_s / dt_s).clamp(1.0, MOST_STEPS) as u32,
        })
    }

    /// The loop at rest, knowing only what its compensator was told to start from; the next
    /// sample is where angles count from. This is also the reset.
    pub fn start(&self) -> State<T, C::State> {
        State {
            compensator: self.compensator.start(),
            encoder: encoder::State::default(),
            velocity_rad_s: T::ZERO,
            target: Target {
                value: T::ZERO,
                rate: T::ZERO,
            },
            applied_v: T::ZERO,
            pushed: 0,
            doubt: 0,
            doubts: 0,
            limited: 0,
            blind: 0,
        }
    }

    /// One step: the counter's value and where to be, in; the voltage, with its parts, out.
    #[inline]
    pub fn step(
        &self,
        state: &mut State<T, C::State>,
        counter: u32,
        target: &Target<T>,
    ) -> Parts<T> {
        let mut status = Status::OK;
        if target.value.is_finite() && target.rate.is_finite() {
            state.target = *target;
        } else {
            state.target.rate = T::ZERO;
            status |= Status::NOT_FINITE;
        }
        let sample = self.encoder.step(&mut state.encoder, counter);
        status |= self.sight(state, &sample);
        let blind = self.patience_over(state, status);
        let measured = self
            .observer
            .measure(state.velocity_rad_s, sample.moved_rad);
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
        let [wanted_rad_s, wanted_rad_s2] = self.law.wanted(&state.target);
        let answer = self.compensator.step(
            &mut state.compensator,
            &Sense {
                angle_rad,
                velocity_rad_s: v,
                error,
                wanted_rad_s,
                wanted_rad_s2,
                base_v,
                may_learn: !blind && state.limited == 0,
            },
        );
        let alone = blind || state.limited >= self.patience || !answer.sum_v.is_finite();
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
        let carried = self.observer.carry(measured, base_v);
        state.velocity_rad_s = if carried.is_finite() {
            carried
        } else {
            T::ZERO
        };
        state.applied_v = output_v;
        Parts {
            angle_rad,
            velocity_rad_s: v,
            error,
            base_v,
            compensation: answer,
            output_v,
            status,
        }
    }

    /// Is the encoder to be believed?
    #[inline]
    fn sight(&self, state: &mut State<T, C::State>, sample: &encoder::Sample<T>) -> Status {
        let mut status = Status::OK;
        if sample.jumped {
            status |= Status::JUMPED;
        }
        if sample.still == 0 {
            state.pushed = 0;
        } else if state.applied_v.abs() >= self.moving_v {
            state.pushed = state.pushed.saturating_add(1);
        } else if state.pushed < self.patience {
            // Once frozen, only a count shows that the encoder lives again.
            state.pushed = 0;
        }
        if sample.still == 0 {
            (state.doubt, state.doubts) = (0, 0);
        } else if self.compensator.doubts(&state.compensator) {
            // A doubt may be wrong, and the control law alone too weak to show it: compensation is
            // tried again, after a time that doubles.
            state.doubt = self.patience << state.doubts.min(LONGEST_DOUBT);
            state.doubts = state.doubts.saturating_add(1);
        } else {
            state.doubt = state.doubt.saturating_sub(1);
        }
        if state.pushed >= self.patience || state.doubt > 0 {
            status |= Status::FROZEN;
        }
        status
    }

    /// Blind now, or so short a time ago that it may come back.
    #[inline]
    fn patience_over(&self, state: &mut State<T, C::State>, status: Status) -> bool {
        let unsound = Status::FROZEN | Status::JUMPED | Status::NOT_FINITE;
        if status.has(unsound) {
            state.blind = self.patience;
        } else {
            state.blind = state.blind.saturating_sub(1);
        }
        state.blind > 0
    }
}
