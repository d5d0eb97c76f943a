//! Seven-parameter model: a spring before breakaway, a Stribeck curve with pure delay in sliding,
//! and static friction that rises with the time at rest.
//!
//! ```text
//! stuck:    F = k_t x                                      until |F| = F_c + F_s(t_2)
//! sliding:  F = [F_c + F_v |v| + F_s(t_2) / (1 + (v(t - tau_L)/v_s)^2)] sgn(v)
//! F_s(t_2) = F_s,a + (F_s,inf - F_s,a) t_2 / (t_2 + gamma)
//! ```
//!
//! The variable t_2 is the time since the contact stuck, and F_s,a the Stribeck part of friction at
//! the end of the last sliding. With tau_L = 0, this part is fully restored at every stop, so
//! static friction rises with time only if tau_L is positive.
//!
//! Source: Armstrong-Helouvry & Dupont (1993); Armstrong-Helouvry, Dupont & Canudas de Wit (1994);
//! Cohn (1998), section 2.3.1.
//!
//! At a stop the spring keeps its deflection: the force does not jump. A run starts after a long
//! rest.
//!
//! ```
//! use jbf_core::law::seven_parameter::{SevenParameter, Parameters};
//! use jbf_core::{Chain, Motion};
//!
//! let chain = Chain::new(SevenParameter::new(Parameters { f_c: 4.0, f_s_inf: 2.0, ..Parameters::default() })?);
//! let mut state = chain.start(&Motion::default());
//! for _ in 0..100 {
//!     chain.step_velocity(&mut state, 0.01, 0.001);
//! }
//! assert!(state.reading_n > 3.0 && state.reading_n < 7.0);
//! # Ok::<(), jbf_core::Error>(())
//! ```

use super::newtons::{in_newtons, moving};
use super::registry::named_law;
use super::{Info, Law, SteadyCurve};
use crate::delay_line::{self, DelayLine};
use crate::described::described;
use crate::error::Error;
use crate::friction::Friction;
use crate::motion::JournalMotion;
use crate::path::{legs, Leg};
use crate::real::Real;

/// Longest inner step of a prediction, s; breakaway is resolved to one step.
pub(crate) const LONGEST_STEP_S: f64 = 0.002;
/// Number of points of the delay line of the speed; each step longer than `tau_L / (DELAY_POINTS - 4)` is
/// a point.
pub(crate) const DELAY_POINTS: usize = delay_line::POINTS;

/// Seven-parameter model with presliding, Stribeck curve, frictional memory and rising static
/// friction.
#[derive(Clone, Copy, Debug)]
pub struct SevenParameter<T> {
    stiffness_n_m: T,
    coulomb_n: T,
    viscous_n_s_m: T,
    static_n: T,
    stribeck_m_s: T,
    delay_s: T,
    dwell_s: T,
}

/// State of the contact in the seven-parameter model.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    /// Direction of sliding, -1 or +1; zero while the contact sticks.
    way: T,
    /// Force without the viscous part, N.
    force_n: T,
    /// Stribeck part at the end of the last sliding, N.
    arrival_n: T,
    /// Present Stribeck part of friction, N.
    grown_n: T,
    /// Time since the contact stuck, s.
    stuck_s: T,
    /// Speed |v| at the time of the delay `tau_L` ago, m/s.
    late_m_s: T,
    line: DelayLine<T>,
}

impl<T: Real> SevenParameter<T> {
    /// Fraction of the Stribeck part that remains at a (delayed) speed.
    #[inline(always)]
    fn share(&self, speed_m_s: T) -> T {
        let x = speed_m_s / self.stribeck_m_s;
        T::ONE / (T::ONE + x * x)
    }

    /// Changes the state from sliding to sticking.
    #[inline(always)]
    fn stop(&self, state: &mut State<T>) {
        if state.way != T::ZERO {
            state.way = T::ZERO;
            state.arrival_n = state.grown_n * self.share(state.late_m_s);
            state.stuck_s = T::ZERO;
        }
    }

    /// Advances the state along one leg (a part of a step in one direction): the spring deflects,
    /// breaks away, or the contact slides.
    #[inline(always)]
    fn slide(&self, state: &mut State<T>, leg: &Leg<T>) {
        let (way, level) = (leg.direction, leg.level[1]);
        if way == T::ZERO || way != state.way {
            self.stop(state);
        }
        if state.way == T::ZERO {
            state.force_n += self.stiffness_n_m * leg.distance_m * way;
            if way != T::ZERO && state.force_n * way >= level {
                state.way = way;
            }
        }
        // A spring deflected beyond a level that fell meanwhile keeps its force; it relaxes on
        // reversal.
        if state.way != T::ZERO {
            state.force_n = level * way;
        }
    }
}

described! {
    named_law SevenParameter = Info::new::<T, Self>("seven_parameter")
        .summary(
            "elastic contact, Stribeck curve with a pure delay, static friction that \
                  grows at rest",
        )
        .equation(
            "stuck: F = k_t x; sliding: F = [F_c + F_v |v| + F_s(t_2)/(1 + (v(t-tau_L)/v_s)^2)] \
                   sgn(v); F_s(t_2) = F_sa + (F_s_inf - F_sa) t_2/(t_2 + gamma)",
        )
        .source("Armstrong-Helouvry & Dupont 1993; Cohn 1998, section 2.3.1")
        .limits("switches between stuck and sliding; growing static friction needs tau_L > 0");
    k_t = "k_t", "N/m", "stiffness of the stuck contact",
        [1e-2, 1e12], [1e5, 1e6, 1e4] .log();
    F_c;
    F_v;
    f_s_inf = "F_s_inf", "N", "Stribeck friction after a long rest; breakaway is at F_c + F_s",
        [1e-6, 1e7], [3.0] .log();
    v_s;
    // The delay may be zero, so it is not a scale.
    tau_l_s = "tau_L_s", "s", "delay of friction relative to the speed", [0.0, 1.0], [0.01, 0.1];
    gamma_s = "gamma_s", "s", "rest duration in which half of the static friction recovers",
        [1e-4, 1e5], [1.0] .log();
}

impl<T: Real> SevenParameter<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            stiffness_n_m: p.k_t,
            coulomb_n: p.f_c,
            viscous_n_s_m: p.f_v,
            static_n: p.f_s_inf,
            stribeck_m_s: p.v_s,
            delay_s: p.tau_l_s,
            dwell_s: p.gamma_s,
        }
    }
}

impl<T: Real> Law<T> for SevenParameter<T> {
    type State = State<T>;

    const HAS_BRISTLE: bool = true;

    const ENOUGH_STEPS: f64 = 16.0;

    in_newtons!();

    fn start(&self, _load_n: T) -> State<T> {
        State {
            way: T::ZERO,
            force_n: T::ZERO,
            arrival_n: self.static_n,
            grown_n: self.static_n,
            stuck_s: T::ZERO,
            late_m_s: T::ZERO,
            line: DelayLine::new(),
        }
    }

    #[inline(always)]
    fn friction(&self, state: &State<T>, velocity_m_s: T) -> Friction<T> {
        // At its first sample a run has no history; the speed before it is taken as constant.
        let late = if state.line.is_empty() {
            velocity_m_s
        } else {
            state.late_m_s
        };
        Friction {
            jump: self.coulomb_n + state.grown_n * self.share(late),
            smooth: self.viscous_n_s_m * velocity_m_s,
        }
    }

    fn longest_step_s(&self, _top_speed_m_s: f64) -> f64 {
        LONGEST_STEP_S
    }

    #[inline(always)]
    fn advance(&self, state: &mut State<T>, speed_m_s: [T; 3], _rate: T, dt_s: T) {
        if state.line.is_empty() {
            state.line.push(speed_m_s[0], T::ZERO, self.delay_s);
        }
        state.line.push(speed_m_s[2], dt_s, self.delay_s);
        state.late_m_s = state.line.back(self.delay_s);
        if state.way == T::ZERO {
            state.stuck_s += dt_s;
            let share = state.stuck_s / (state.stuck_s + self.dwell_s);
            state.grown_n = state.arrival_n + (self.static_n - state.arrival_n) * share;
        }
    }

    #[inline(always)]
    fn bend(
        &self,
        state: &mut State<T>,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        level: [T; 2],
        dt_s: T,
    ) -> T {
        if dt_s.value() <= 0.0 {
            state.way = to.velocity_m_s.sign();
            state.force_n = level[1] * state.way;
            return state.force_n;
        }
        let turning = |_| (level[0] + level[1]) * T::of(0.5);
        for leg in legs(from, to, level, turning, dt_s).iter().flatten() {
            self.slide(state, leg);
        }
        if to.velocity_m_s == T::ZERO {
            self.stop(state);
        }
        state.force_n
    }
}

impl SteadyCurve for SevenParameter<f64> {
    /// Returns the friction of steady sliding after a breakaway from a long rest, N.
    fn steady_n(&self, velocity_m_s: f64) -> Result<f64, Error> {
        moving(velocity_m_s)?;
        let level = self.coulomb_n + self.static_n * self.share(velocity_m_s);
        Ok(level * velocity_m_s.sign() + self.viscous_n_s_m * velocity_m_s)
    }
}
