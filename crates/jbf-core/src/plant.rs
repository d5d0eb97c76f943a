//! Simulated shaft with a motor, an encoder and friction, for the analysis of control loops.
//!
//! ```text
//! v' = -a v + b (u - F(v, ...)),   x' = v,   |u| <= limit
//! ```
//!
//! F, in volts, is the friction of any law with any effects, and may be set-valued at v = 0. A step
//! is implicit in F: the first trial is at rest, and only a force above the friction level moves
//! the shaft (a proximal step, after Moreau 1988). The shaft therefore sticks without chattering. A
//! step without friction is exact for a constant input.
//!
//! Source: Cohn (1998), chapter 6 and Appendices D and E. The observer of Appendix E is the
//! observer of this plant with a = 135 1/s, b = 457 rad/s^2/V; its feed-forward 0.295 is a/b.
// `!(x > 0)` is intentionally true for NaN too.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::builder::with_fields;
use crate::chain::{self, Chain};
use crate::effect::{Effect, Effects};
use crate::error::{not_negative, positive, Error};
use crate::friction::Friction;
use crate::law::Law;
use crate::motion::Motion;
use crate::real::Real;

/// Largest number of trial speeds per step; a bristle requires three or four.
const MOST_TRIALS: u32 = 24;

/// Absolute tolerance of the speed at the end of a step, rad/s; `NEAR` is the relative tolerance.
///
/// The speed is solved again at every step, so errors do not accumulate.
const NEAR_RAD_S: f64 = 1e-7;
const NEAR: f64 = 1e-6;

/// Speed that no shaft exceeds, rad/s.
///
/// If no speed balances the friction, the shaft does not move in the step. This happens if friction
/// falls with speed more than the inertia of the shaft allows, or if a force is not finite.
const LOST_RAD_S: f64 = 1e9;

/// Longest step of the film during a rest, s; the film closes slowly, so short steps are
/// unnecessary.
const LONGEST_STANDING_S: f64 = 0.02;

/// Motor and shaft of a control loop: `v' = -a v + b (u - F)`, with the voltage `u` and the friction
/// `F` in volts.
///
/// For a drive with a torque controller, read N m for V: `a` is zero, `b` the inverse of the inertia,
/// and `volts_per_n` 1.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Drive {
    /// Damping `a` without friction, 1/s, caused by the back-EMF of the motor.
    pub damping_1_s: f64,
    /// Input gain `b`, rad/s^2/V.
    pub input_rad_s2_v: f64,
    /// Voltage that corresponds to one newton of friction on one bearing, V/N.
    pub volts_per_n: f64,
    /// Largest input voltage, V.
    pub limit_v: f64,
}

impl Drive {
    /// Motor and shaft of Cohn (1998).
    ///
    /// The friction scale is not given there: `volts_per_n` is fitted to the columns "none" of
    /// Tables 6.1 and 6.2, as `jbf control tables` does.
    pub const THESIS: Self = Self {
        damping_1_s: 135.0,
        input_rad_s2_v: 457.0,
        volts_per_n: 0.02826,
        limit_v: 10.0,
    };

    /// Creates a drive from its damping a (1/s) and input gain b (rad/s^2/V).
    ///
    /// Set the friction scale and the largest input of your drive with
    /// [`with_volts_per_n`](Self::with_volts_per_n) and [`with_limit_v`](Self::with_limit_v). Until
    /// then they are those of Cohn (1998), 0.02826 V/N and 10 V.
    #[must_use]
    pub const fn new(damping_1_s: f64, input_rad_s2_v: f64) -> Self {
        Self {
            damping_1_s,
            input_rad_s2_v,
            ..Self::THESIS
        }
    }

    with_fields! {
        with_volts_per_n => volts_per_n: f64,
        with_limit_v => limit_v: f64,
    }

    /// Returns true if the damping and the input gain equal those of another drive.
    #[must_use]
    pub(crate) fn has_same_dynamics(&self, other: &Self) -> bool {
        self.damping_1_s == other.damping_1_s && self.input_rad_s2_v == other.input_rad_s2_v
    }

    /// Returns twice the speed that the largest input sustains without friction, rad/s.
    ///
    /// An [`Encoder`](crate::encoder::Encoder) attributes a higher speed to a jump of the counter. The
    /// speed is infinite for a drive without damping: give the encoder a limit of the machine instead.
    #[must_use]
    pub fn top_speed_rad_s(&self) -> f64 {
        2.0 * self.limit_v * self.input_rad_s2_v / self.damping_1_s
    }
}

/// Fraction of its speed that a drive without friction loses in a step, and the speed that it gains
/// per volt, rad/s/V: the solution of `v' = -a v + b u` for a constant input.
pub(crate) fn step_response(damping_1_s: f64, input_rad_s2_v: f64, step_s: f64) -> [f64; 2] {
    let fall = -libm::expm1(-damping_1_s * step_s);
    let gain = if damping_1_s > 0.0 {
        input_rad_s2_v / damping_1_s * fall
    } else {
        input_rad_s2_v * step_s
    };
    [fall, gain]
}

/// Simulated shaft with a drive and a friction chain, with precomputed constants.
#[derive(Clone, Copy, Debug)]
pub struct Plant<T: Real, L, E = Effects<T>> {
    chain: Chain<T, L, E>,
    keep: T,
    gain: T,
    volts_per_n: T,
    limit_v: T,
    step_s: T,
}

/// State of the simulated shaft.
#[derive(Clone, Copy, Debug)]
pub struct State<T: Real, S, E: Effect<T> = Effects<T>> {
    /// Angle of the shaft, rad.
    pub angle_rad: T,
    /// Speed of the shaft, rad/s.
    pub speed_rad_s: T,
    /// Friction, V; while the shaft sticks, the force that holds it.
    pub friction_v: T,
    /// Extrapolated change of friction in the next step, V.
    change_v: T,
    time_s: T,
    chain: chain::State<T, S, E>,
}

/// State at the start of a step, and the inputs of the step.
///
/// Each trial of a step starts from this state and stores its end in [`State`].
struct Before<T: Real, S, E: Effect<T>> {
    chain: chain::State<T, S, E>,
    speed_rad_s: T,
    angle_rad: T,
    /// Speed at the end of the step without friction, rad/s.
    free: T,
    load_n: T,
}

impl<T: Real, L: Law<T>, E: Effect<T>> Plant<T, L, E> {
    /// Creates a plant that advances by `step_s`, with which the law must be stable.
    ///
    /// # Errors
    /// Reports the number that violates its rule: the damping must be zero or positive, `volts_per_n`
    /// too, and the other numbers positive.
    pub fn new(chain: Chain<T, L, E>, drive: Drive, step_s: f64) -> Result<Self, Error> {
        not_negative("damping_1_s", drive.damping_1_s)?;
        positive("input_rad_s2_v", drive.input_rad_s2_v)?;
        positive("limit_v", drive.limit_v)?;
        positive("step_s", step_s)?;
        not_negative("volts_per_n", drive.volts_per_n)?;
        let [fall, gain] = step_response(drive.damping_1_s, drive.input_rad_s2_v, step_s);
        Ok(Self {
            chain,
            keep: T::of(1.0 - fall),
            gain: T::of(gain),
            volts_per_n: T::of(drive.volts_per_n),
            limit_v: T::of(drive.limit_v),
            step_s: T::of(step_s),
        })
    }

    /// Returns the state at angle zero under a load (N), after a rest of `stood_s`.
    ///
    /// During the rest, the film is squeezed out and the contact ages.
    #[must_use]
    pub fn start(&self, load_n: T, stood_s: f64) -> State<T, L::State, E> {
        let mut motion = Motion::at_rest(load_n);
        let mut chain = self.chain.start(&motion);
        let longest = LONGEST_STANDING_S
            .min(self.chain.law.longest_step_s(0.0) / self.chain.effects.fastest_film())
            .min(self.chain.effects.longest_step_s());
        let steps = libm::ceil(stood_s / longest).clamp(0.0, 1e7);
        let step_s = T::of(stood_s / steps.max(1.0));
        for _ in 0..steps as u32 {
            motion.time_s += step_s;
            self.chain.step(&mut chain, &motion, step_s);
        }
        State {
            angle_rad: T::ZERO,
            speed_rad_s: T::ZERO,
            friction_v: T::ZERO,
            change_v: T::ZERO,
            time_s: motion.time_s,
            chain,
        }
    }

    /// Advances the shaft by one step under an input (V) and a load (N).
    #[inline]
    pub fn step(&self, state: &mut State<T, L::State, E>, input_v: T, load_n: T) {
        let u = input_v.max(-self.limit_v).min(self.limit_v);
        let free = self.keep * state.speed_rad_s + self.gain * u;
        let before = Before {
            chain: state.chain,
            speed_rad_s: state.speed_rad_s,
            angle_rad: state.angle_rad,
            free,
            load_n,
        };
        if !self.sliding_on(state, &before) {
            self.leave_rest(state, &before);
        }
        // Also true for NaN.
        if !(state.speed_rad_s.abs() <= T::of(LOST_RAD_S)) {
            self.attempt(state, &before, T::ZERO);
        }
        // Force required by the motion of the step; at rest, the holding force.
        let friction_v = (free - state.speed_rad_s) / self.gain;
        state.change_v = friction_v - state.friction_v;
        state.friction_v = friction_v;
        state.time_s += self.step_s;
    }

    /// Computes a step in which the shaft continues in its direction.
    ///
    /// Returns false, and an invalid state, if there is no such step.
    #[inline]
    fn sliding_on(
        &self,
        state: &mut State<T, L::State, E>,
        before: &Before<T, L::State, E>,
    ) -> bool {
        let side = before.speed_rad_s.sign();
        let guess = before.free - self.gain * (state.friction_v + state.change_v);
        if !(guess * side > T::ZERO) {
            return false;
        }
        self.solve(state, before, guess, side);
        state.speed_rad_s * side > T::ZERO
    }

    /// Computes a step that may stick: only a force above the friction at rest moves the shaft.
    #[inline]
    fn leave_rest(&self, state: &mut State<T, L::State, E>, before: &Before<T, L::State, E>) {
        let still = self.attempt(state, before, T::ZERO);
        let push = before.free - self.gain * still.smooth;
        let hold = self.gain * still.jump;
        let side = push.sign();
        if push.abs() <= hold {
            // In the backlash of a drive nothing holds the shaft: it moves without friction.
            if self.chain.effects.has_drive() && side != T::ZERO {
                if self.attempt(state, before, push).jump == T::ZERO {
                    return;
                }
                self.attempt(state, before, T::ZERO);
            }
            return;
        }
        // A bristle has no jump: nothing keeps the shaft on one side of rest.
        let kept = if hold > T::ZERO { side } else { T::ZERO };
        self.solve(state, before, push - hold * side, kept);
        if state.speed_rad_s * kept < T::ZERO {
            self.attempt(state, before, T::ZERO);
        }
    }

    /// Finds the speed at which `v - free + gain F(v)` is zero, by the secant method.
    ///
    /// `guess` is the first trial (rad/s). The speed has the sign `side`, or any sign if `side` is
    /// zero.
    #[inline]
    fn solve(
        &self,
        state: &mut State<T, L::State, E>,
        before: &Before<T, L::State, E>,
        guess: T,
        side: T,
    ) {
        let direction = |v: T| if side == T::ZERO { v.sign() } else { side };
        let missed =
            |v: T, felt_v: &Friction<T>| v - before.free + self.gain * felt_v.along(direction(v));
        let mut here = guess;
        let mut miss = missed(here, &self.attempt(state, before, here));
        let mut slope = T::ONE;
        for _ in 0..MOST_TRIALS {
            if miss.abs() <= T::of(NEAR_RAD_S) + T::of(NEAR) * here.abs() {
                break;
            }
            let next = here - miss / slope;
            let run = next - here;
            if !(run.abs() > T::ZERO) {
                break;
            }
            let after = missed(next, &self.attempt(state, before, next));
            // Friction that falls with speed reduces the slope; this is its lower limit.
            slope = ((after - miss) / run).max(T::of(0.2));
            (here, miss) = (next, after);
        }
    }

    /// Advances the chain from the start of the step to an end with the given speed.
    ///
    /// Returns the friction at the end of the step, V.
    #[inline]
    fn attempt(
        &self,
        state: &mut State<T, L::State, E>,
        before: &Before<T, L::State, E>,
        speed_rad_s: T,
    ) -> Friction<T> {
        let radius_m = self.chain.rig.radius_m;
        let h = self.step_s;
        let way_rad = (before.speed_rad_s + speed_rad_s) * (h * T::of(0.5));
        let angle_rad = before.angle_rad + way_rad;
        let to = Motion {
            time_s: state.time_s + h,
            velocity_m_s: speed_rad_s * radius_m,
            acceleration_m_s2: (speed_rad_s - before.speed_rad_s) * radius_m / h,
            angle_rad,
            weight_offset_rad: T::ZERO,
            load_n: before.load_n,
            temperature_c: None,
        };
        state.chain = before.chain;
        self.chain.step(&mut state.chain, &to, h);
        let reaction_n = self.chain.reaction_n(&state.chain);
        state.speed_rad_s = speed_rad_s;
        state.angle_rad = angle_rad;
        reaction_n.times(self.volts_per_n)
    }
}
