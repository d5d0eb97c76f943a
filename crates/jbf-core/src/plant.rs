//! A shaft with a motor, an encoder's side and friction, for analysis: the plant that the
//! thesis's own gains describe.
//!
//! ```text
//! v' = -a v + b (u - F(v, ...)),   x' = v,   |u| <= limit
//! ```
//!
//! F, in volts, is any law with any effects; it may be set-valued at v = 0. A step is implicit in
//! F: first the shaft is tried at rest, where friction holds up to its level, and only what passes
//! that moves it (a proximal step, after Moreau 1988). So it sticks and does not chatter. Without
//! friction a step is exact for a constant input.
//!
//! Source: Cohn (1998), chapter 6 and Appendices D and E. The observer of Appendix E is the
//! observer of this plant with a = 135 1/s, b = 457 rad/s^2/V; its feed-forward 0.295 is a/b.
// `!(x > 0)` is true of a NaN too, and means to be.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

use crate::chain::{self, Chain};
use crate::error::{check, positive, ParameterError};
use crate::law::Law;
use crate::motion::Motion;
use crate::real::Real;

/// Most trials of one step: a bristle takes three or four.
const MOST_TRIALS: u32 = 24;

/// A step's speed is solved to this, rad/s, and to this share of itself. It is solved anew at every
/// step, so that errors do not add up.
const NEAR_RAD_S: f64 = 1e-7;
const NEAR: f64 = 1e-6;

/// Standing still needs no short steps: the film closes slowly.
const LONGEST_STANDING_S: f64 = 0.02;

/// Motor and shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Damping `a`, 1/s.
    pub damping_1_s: f64,
    /// Input gain `b`, rad/s^2/V.
    pub input_rad_s2_v: f64,
    /// What one newton of friction on one bearing is in volts.
    pub volts_per_n: f64,
    /// Largest input, V.
    pub limit_v: f64,
}

impl Drive {
    /// The thesis's motor and shaft. Its friction scale is not in the thesis: `volts_per_n` is
    /// what fits the "none" column of its Tables 6.1 and 6.2.
    pub const THESIS: Self = Self {
        damping_1_s: 135.0,
        input_rad_s2_v: 457.0,
        volts_per_n: 0.03,
        limit_v: 10.0,
    };
}

/// The plant, ready to step.
#[derive(Clone, Copy, Debug)]
pub struct Plant<T: Real, L> {
    chain: Chain<T, L>,
    keep: T,
    gain: T,
    volts_per_n: T,
    limit_v: T,
    step_s: T,
}

/// Where the shaft is.
#[derive(Clone, Copy, Debug)]
pub struct State<T: Real, S> {
    /// Angle, rad.
    pub angle_rad: T,
    /// Speed, rad/s.
    pub speed_rad_s: T,
    /// Friction, V; what holds the shaft where it sticks.
    pub friction_v: T,
    time_s: T,
    chain: chain::State<T, S>,
}

/// One candidate for the end of a step.
#[derive(Clone, Copy)]
struct Trial<T: Real, S> {
    chain: chain::State<T, S>,
    speed_rad_s: T,
    angle_rad: T,
    jump_v: T,
    smooth_v: T,
}

impl<T: Real, L: Law<T>> Plant<T, L> {
    /// A plant that takes steps of `step_s`. The law's own stepper must bear that step.
    ///
    /// # Errors
    /// Names the number that is not positive and finite.
    pub fn new(chain: Chain<T, L>, drive: Drive, step_s: f64) -> Result<Self, ParameterError> {
        positive("damping_1_s", drive.damping_1_s)?;
        positive("input_rad_s2_v", drive.input_rad_s2_v)?;
        positive("limit_v", drive.limit_v)?;
        positive("step_s", step_s)?;
        check(
            drive.volts_per_n >= 0.0 && drive.volts_per_n.is_finite(),
            "volts_per_n",
            drive.volts_per_n,
            "must be zero or positive, and finite",
        )?;
        let fall = -libm::expm1(-drive.damping_1_s * step_s);
        Ok(Self {
            chain,
            keep: T::of(1.0 - fall),
            gain: T::of(drive.input_rad_s2_v / drive.damping_1_s * fall),
            volts_per_n: T::of(drive.volts_per_n),
            limit_v: T::of(drive.limit_v),
            step_s: T::of(step_s),
        })
    }

    /// At rest at angle zero under a load (N), having stood for `stood_s`: the film has been
    /// squeezed out, the contact has aged.
    pub fn start(&self, load_n: T, stood_s: f64) -> State<T, L::State> {
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
            time_s: motion.time_s,
            chain,
        }
    }

    /// One step under an input (V) and a load (N).
    #[inline]
    pub fn step(&self, state: &mut State<T, L::State>, input_v: T, load_n: T) {
        let u = input_v.max(-self.limit_v).min(self.limit_v);
        let free = self.keep * state.speed_rad_s + self.gain * u;
        let end = self
            .sliding_on(state, free, load_n)
            .unwrap_or_else(|| self.leave_rest(state, free, load_n));
        // What the step's motion needed: at rest, whatever holds the shaft.
        state.friction_v = (free - end.speed_rad_s) / self.gain;
        state.speed_rad_s = end.speed_rad_s;
        state.angle_rad = end.angle_rad;
        state.time_s += self.step_s;
        state.chain = end.chain;
    }

    /// A step that keeps its direction, where it does.
    #[inline]
    fn sliding_on(
        &self,
        state: &State<T, L::State>,
        free: T,
        load_n: T,
    ) -> Option<Trial<T, L::State>> {
        let side = state.speed_rad_s.sign();
        let guess = free - self.gain * state.friction_v;
        if !(guess * side > T::ZERO) {
            return None;
        }
        let end = self.solve(state, free, guess, side, load_n);
        (end.speed_rad_s * side > T::ZERO).then_some(end)
    }

    /// A step that may stick: only what friction at rest cannot hold moves the shaft.
    #[inline]
    fn leave_rest(&self, state: &State<T, L::State>, free: T, load_n: T) -> Trial<T, L::State> {
        let still = self.attempt(state, T::ZERO, load_n);
        let push = free - self.gain * still.smooth_v;
        let hold = self.gain * still.jump_v;
        let side = push.sign();
        if push.abs() <= hold {
            // In the gap of a drive nothing holds: it moves as if there were no friction.
            if self.chain.effects.has_drive() && side != T::ZERO {
                let loose = self.attempt(state, push, load_n);
                if loose.jump_v == T::ZERO {
                    return loose;
                }
            }
            return still;
        }
        // A bristle has no jump: nothing keeps the shaft on one side of rest.
        let kept = if hold > T::ZERO { side } else { T::ZERO };
        let end = self.solve(state, free, push - hold * side, kept, load_n);
        if end.speed_rad_s * kept < T::ZERO {
            still
        } else {
            end
        }
    }

    /// The root of `v - free + gain F(v)` on one side of rest (any, where `side` is zero), by
    /// secants from a guess.
    #[inline]
    fn solve(
        &self,
        state: &State<T, L::State>,
        free: T,
        guess: T,
        side: T,
        load_n: T,
    ) -> Trial<T, L::State> {
        let direction = |v: T| if side == T::ZERO { v.sign() } else { side };
        let missed = |t: &Trial<T, L::State>| {
            let friction_v = t.jump_v * direction(t.speed_rad_s) + t.smooth_v;
            t.speed_rad_s - free + self.gain * friction_v
        };
        let mut here = self.attempt(state, guess, load_n);
        let mut miss = missed(&here);
        let mut slope = T::ONE;
        for _ in 0..MOST_TRIALS {
            if miss.abs() <= T::of(NEAR_RAD_S) + T::of(NEAR) * here.speed_rad_s.abs() {
                break;
            }
            let next = self.attempt(state, here.speed_rad_s - miss / slope, load_n);
            let after = missed(&next);
            let run = next.speed_rad_s - here.speed_rad_s;
            if !(run.abs() > T::ZERO) {
                break;
            }
            // Friction that falls with speed makes the slope small, never so small.
            slope = ((after - miss) / run).max(T::of(0.2));
            (here, miss) = (next, after);
        }
        here
    }

    /// What the chain makes of a step that ends with a speed.
    #[inline]
    fn attempt(&self, state: &State<T, L::State>, speed_rad_s: T, load_n: T) -> Trial<T, L::State> {
        let radius_m = self.chain.rig.radius_m;
        let h = self.step_s;
        let angle_rad = state.angle_rad + (state.speed_rad_s + speed_rad_s) * (h * T::of(0.5));
        let to = Motion {
            time_s: state.time_s + h,
            velocity_m_s: speed_rad_s * radius_m,
            acceleration_m_s2: (speed_rad_s - state.speed_rad_s) * radius_m / h,
            angle_rad,
            load_n,
        };
        let mut chain = state.chain;
        self.chain.step(&mut chain, &to, h);
        let felt = self.chain.felt(&chain);
        Trial {
            chain,
            speed_rad_s,
            angle_rad,
            jump_v: felt.jump_n * self.volts_per_n,
            smooth_v: felt.smooth_n * self.volts_per_n,
        }
    }
}
