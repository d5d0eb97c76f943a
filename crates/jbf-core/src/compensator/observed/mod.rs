//! Friction model corrected by an observer, as proposed in chapter 7 of Cohn (1998).
//!
//! The model, a law with its effects, predicts the friction: a `level` with the direction `dir` of
//! the motion, and a `smooth` part. An observer of the plant estimates the remaining disturbance
//! `d`, and a part `c` of it is learned as friction:
//!
//! ```text
//! F_hat = (level + c) dir + smooth + d
//! v' = -a v + b (u - F_hat), set-valued at rest;  d' = 0
//! corrected by l (measured - predicted) from the angle alone, poles at -w, -w, -max(a, w)
//! c' = mu d dir  (and d falls by as much: a disturbance that reverses with the motion is friction)
//! ```
//!
//! Here `w` is [`Settings::bandwidth_rad_s`] and `mu` is [`Settings::learning_1_s`].
//!
//! `smooth` is evaluated at the start of the step, except for a viscous friction so steep that the
//! shaft would reverse within the step. With the slope s of this friction (V s/rad) the step is
//!
//! ```text
//! v+ = keep v + gain (u - s v - ...)     keep = exp(-a dt): rings beyond s = (1 + keep)/gain
//! v+ = keep' v + gain' (u - ...)         keep' = exp(-(a + b s) dt): stable for any s
//! ```
//!
//! The second form is used where `gain s > keep` and the first would reverse the shaft. It is also
//! used where `gain s > keep` and the observer is blind, because no measurement then limits the
//! estimate. Both forms have the same steady speed. Otherwise, in the first form, the voltage that
//! the loop applies against smooth friction cancels that friction exactly.
//!
//! The observer includes stiction like the plant, so its estimates do not drift at rest. The
//! compensator outputs F_hat, where `dir` is the direction of the wanted motion if the shaft is
//! slow. The compensator adds the voltage that the plant needs for the reference motion.
//!
//! Source: extended state observers (Han 1995; Gao 2003); disturbance observers (Ohnishi 1987);
//! Friedland & Park (1992) for learning a level that takes the sign of the motion; Cohn (1998),
//! chapter 7.

// `!(x <= y)` is intentionally true for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod poles;
mod settings;

pub use settings::Settings;

use super::model::FrictionModel;
use super::{Compensator, Input, Output};
use crate::error::{check, Error};
use crate::friction::Friction;
use crate::plant::step_response;
use crate::real::Real;
use poles::poles;

/// Time within which the observer corrects a wrong friction estimate, in time constants of the
/// observer.
///
/// The encoder is considered faulty if the observer infers a rotation without a count for longer
/// than this time, at the speed that the largest correction causes.
const FINDING_OUT: f64 = 3.0;

/// Speed above which the observer is considered divergent and restarts, rad/s; no shaft turns
/// faster.
const LOST_RAD_S: f64 = 1e6;

/// Learned corrections of the friction model, which are worth storing while the power is off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Learned<T> {
    /// Correction of the friction level of the model, V.
    pub level_v: T,
    /// Disturbance that does not change sign with the motion, V.
    pub rest_v: T,
}

/// Compensator with a friction model that an observer corrects.
#[derive(Clone, Copy, Debug)]
pub struct Observed<T, M> {
    /// Friction model.
    pub model: M,
    keep: T,
    gain: T,
    /// Damping a/b of the plant, V s/rad. With the product b dt of input gain and time step
    /// (`input_rad_s_v`), it is used in a step with steep friction.
    damping_v_s_rad: T,
    input_rad_s_v: T,
    correct: [T; 3],
    learning: T,
    level_limit_v: T,
    rest_limit_v: T,
    slow_rad_s: T,
    inverse_slow: T,
    approach_1_s: T,
    breakaway: T,
    stiffer_v_rad: T,
    stiffer_v_s_rad: T,
    speed_v_s_rad: T,
    acceleration_v_s2_rad: T,
    doubtful_rad: T,
    dt_s: T,
    begin: Learned<T>,
}

/// State of the friction model and the observer, with the learned corrections.
#[derive(Clone, Copy, Debug)]
pub struct State<T, S> {
    model: S,
    friction: Friction<T>,
    /// Slope of the smooth friction if it is too steep for one explicit step, V s/rad; otherwise
    /// zero.
    steep_v_s_rad: T,
    velocity_rad_s: T,
    slip_rad: T,
    /// Rotation of the shaft since the last count, estimated by the observer, rad.
    turned_rad: T,
    /// Learned corrections of the friction model.
    pub learned: Learned<T>,
}

impl<T: Real, M: FrictionModel<T>> Observed<T, M> {
    /// Creates a compensator from a friction model and settings.
    ///
    /// # Errors
    /// Reports the name of the setting that violates its rule.
    pub fn new(model: M, s: &Settings) -> Result<Self, Error> {
        s.check()?;
        let [fall, gain] = step_response(s.damping_1_s, s.input_rad_s2_v, s.dt_s);
        // Without damping, the observer limits the speed that a wrong friction estimate causes.
        let decay_1_s = if s.damping_1_s > 0.0 {
            s.damping_1_s
        } else {
            s.bandwidth_rad_s
        };
        let wrong_rad_s =
            (s.level_limit_v + s.rest_limit_v) * s.input_rad_s2_v / decay_1_s + s.slow_rad_s;
        let doubtful_rad = FINDING_OUT * wrong_rad_s / s.bandwidth_rad_s;
        let correct = poles(
            1.0 - fall,
            gain,
            s.dt_s,
            libm::exp(-s.bandwidth_rad_s * s.dt_s),
        );
        check(
            correct.iter().all(|g| g.is_finite()),
            "bandwidth_rad_s",
            s.bandwidth_rad_s,
            "gives gains that overflow",
        )?;
        Ok(Self {
            model,
            keep: T::of(1.0 - fall),
            gain: T::of(gain),
            damping_v_s_rad: T::of(s.damping_1_s / s.input_rad_s2_v),
            input_rad_s_v: T::of(s.input_rad_s2_v * s.dt_s),
            correct: correct.map(T::of),
            learning: T::of(s.learning_1_s * s.dt_s),
            level_limit_v: T::of(s.level_limit_v),
            rest_limit_v: T::of(s.rest_limit_v),
            slow_rad_s: T::of(s.slow_rad_s),
            inverse_slow: T::of(1.0 / s.slow_rad_s),
            approach_1_s: T::of(s.approach_1_s),
            breakaway: T::of(s.breakaway),
            stiffer_v_rad: T::of(s.stiffer_v_rad),
            stiffer_v_s_rad: T::of(s.stiffer_v_s_rad),
            speed_v_s_rad: T::of(s.damping_1_s / s.input_rad_s2_v - s.law_forward_v_s_rad),
            acceleration_v_s2_rad: T::of(1.0 / s.input_rad_s2_v),
            doubtful_rad: T::of(doubtful_rad),
            dt_s: T::of(s.dt_s),
            begin: Learned {
                level_v: T::ZERO,
                rest_v: T::ZERO,
            },
        })
    }

    /// Starts from the corrections that an earlier run learned, limited to their bounds.
    ///
    /// If any correction is not finite, nothing changes.
    #[must_use]
    pub fn resumed(mut self, learned: Learned<T>) -> Self {
        if learned.level_v.is_finite() && learned.rest_v.is_finite() {
            self.begin = self.held(learned);
        }
        self
    }

    #[inline]
    fn held(&self, l: Learned<T>) -> Learned<T> {
        let within = |x: T, most: T| x.max(-most).min(most);
        Learned {
            level_v: within(l.level_v, self.level_limit_v),
            rest_v: within(l.rest_v, self.rest_limit_v),
        }
    }

    /// Returns the slope of the model's smooth friction, V s/rad, if one explicit step with this
    /// friction would reverse the shaft; zero if the step is stable.
    #[inline]
    fn steep(&self, model: &M::State, velocity_rad_s: T) -> T {
        let way = if velocity_rad_s < T::ZERO {
            -T::ONE
        } else {
            T::ONE
        };
        let slope = self
            .model
            .slope(model, velocity_rad_s.abs().max(self.slow_rad_s) * way);
        if self.gain * slope > self.keep {
            slope
        } else {
            T::ZERO
        }
    }

    /// Returns true if an explicit step with the smooth friction reverses the speed.
    #[inline]
    fn turns_round(&self, velocity_rad_s: T, net_v: T) -> bool {
        (self.keep * velocity_rad_s + self.gain * net_v) * velocity_rad_s < T::ZERO
    }

    /// Restarts the observer from rest and keeps the learned corrections.
    #[cold]
    fn begin_anew(&self, state: &mut State<T, M::State>) {
        let learned = state.learned;
        *state = self.start();
        if learned.level_v.is_finite() && learned.rest_v.is_finite() {
            state.learned = self.held(learned);
        }
    }

    /// Returns the friction level of the model with the correction of the observer, V.
    #[inline]
    fn level_v(&self, state: &State<T, M::State>) -> T {
        (state.friction.jump + state.learned.level_v).max(T::ZERO)
    }
}

impl<T: Real, M: FrictionModel<T>> Compensator<T> for Observed<T, M> {
    type State = State<T, M::State>;

    fn start(&self) -> Self::State {
        let model = self.model.start();
        State {
            friction: self.model.friction(&model),
            steep_v_s_rad: self.steep(&model, T::ZERO),
            model,
            velocity_rad_s: T::ZERO,
            slip_rad: T::ZERO,
            turned_rad: T::ZERO,
            learned: self.begin,
        }
    }

    #[inline]
    fn observe(
        &self,
        state: &mut Self::State,
        _velocity_rad_s: T,
        moved_rad: T,
        applied_v: T,
        blind: bool,
    ) -> T {
        let v = state.velocity_rad_s;
        let net_v = applied_v - state.friction.smooth - state.learned.rest_v;
        let s = state.steep_v_s_rad;
        let (keep, gain, net_v) = if s > T::ZERO && (blind || self.turns_round(v, net_v)) {
            let damping = self.damping_v_s_rad + s;
            let keep = (-damping * self.input_rad_s_v).exp();
            (keep, (T::ONE - keep) / damping, net_v + s * v)
        } else {
            (self.keep, self.gain, net_v)
        };
        let push = keep * v + gain * net_v;
        let hold = gain * self.level_v(state);
        // Proximal step of the plant: friction holds up to its level and no more.
        let mut predicted = if push > hold {
            push - hold
        } else if push < -hold {
            push + hold
        } else {
            T::ZERO
        };
        // Also true for NaN.
        if !(predicted.abs() <= T::of(LOST_RAD_S)) {
            predicted = T::ZERO;
            self.begin_anew(state);
        }
        if blind || moved_rad != T::ZERO {
            state.turned_rad = T::ZERO;
        } else if predicted.abs() > self.slow_rad_s {
            state.turned_rad += predicted * self.dt_s;
        }
        if blind {
            state.velocity_rad_s = predicted;
            state.slip_rad = T::ZERO;
            return predicted;
        }
        let ahead = (v + predicted) * (self.dt_s * T::of(0.5));
        let slip = state.slip_rad + moved_rad - ahead;
        let [angle, speed, rest] = self.correct;
        state.slip_rad = slip - angle * slip;
        state.velocity_rad_s = predicted + speed * slip;
        state.learned.rest_v += rest * slip;
        state.velocity_rad_s
    }

    #[inline]
    fn infers_fault(&self, state: &Self::State) -> bool {
        state.turned_rad.abs() > self.doubtful_rad
    }

    #[inline]
    fn step(&self, state: &mut Self::State, input: &Input<T>) -> Output<T> {
        let v = input.velocity_rad_s;
        let moving = v.abs() > self.slow_rad_s;
        let mut next = state.learned;
        if input.may_learn && moving {
            let share = self.learning * next.rest_v;
            next.level_v += share * v.sign();
            next.rest_v += -share;
        }
        state.learned = self.held(next);
        self.model
            .advance(&mut state.model, v, input.angle_rad, self.dt_s);
        state.friction = self.model.friction(&state.model);
        // Evaluate the slope only where it may be steep, or was steep before.
        if state.steep_v_s_rad > T::ZERO
            || (self.gain * state.friction.smooth).abs() > self.keep * v.abs()
        {
            state.steep_v_s_rad = self.steep(&state.model, v);
        }
        // For a slow shaft, use the direction of the wanted motion, not the noisy estimate.
        let wish = input.reference_rad_s - self.approach_1_s * input.error;
        let asked = (wish * self.inverse_slow).max(-T::ONE).min(T::ONE);
        let level_v = self.level_v(state);
        let signed_v = if moving && v * wish >= T::ZERO {
            level_v * v.sign()
        } else {
            level_v * asked * self.breakaway
        };
        let friction_v = signed_v + state.friction.smooth + state.learned.rest_v;
        let forward_v = self.speed_v_s_rad * input.reference_rad_s
            + self.acceleration_v_s2_rad * input.reference_rad_s2
            - self.stiffer_v_rad * input.error
            - self.stiffer_v_s_rad * (v - input.reference_rad_s);
        Output {
            sum_v: friction_v + forward_v,
            friction_v,
            correction_v: state.learned.level_v * v.sign() + state.learned.rest_v,
            forward_v,
            learned: [state.learned.level_v, state.learned.rest_v],
        }
    }
}
