//! Signal chain: a friction law with effects, advanced one step at a time.
//!
//! ```text
//! commanded motion -> drive -> lubricant -> load -> film (the law)
//!                  -> contact -> transmission -> bristle -> other -> instrument
//! ```
//!
//! Each stage takes its input at both ends of the step and returns its output at the end, so the
//! order of accuracy is that of the integration method. Feedback (a warming film, the load on a
//! compliant drive) uses the values of the previous step.

mod longest_step;

use crate::bearing::Bearing;
use crate::effect::{Effect, Effects, Resistance, Rig, Signal};
use crate::friction::Friction;
use crate::law::Law;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Shortest time step, s. A shorter step counts as a step of zero length, because its inverse would
/// overflow in single precision.
pub(crate) const SHORTEST_STEP_S: f64 = 1e-12;

/// Signal chain: a friction law and the effects between motion, friction and recorded force,
/// evaluated in a fixed order.
#[derive(Clone, Copy, Debug)]
pub struct Chain<T: Real, L, E = Effects<T>> {
    /// The friction law.
    pub law: L,
    /// The effects, each of which acts at its own stage.
    pub effects: E,
    /// Properties of the rig that effects need, such as the journal radius.
    pub rig: Rig<T>,
}

/// State of a chain in the course of a run.
#[derive(Clone, Copy, Debug)]
pub struct State<T: Real, S, E: Effect<T> = Effects<T>> {
    /// State of the friction law.
    pub law: S,
    effects: E::State,
    /// Commanded motion at the last accepted sample.
    pub motion: Motion<T>,
    /// Motion of the journal, which differs from the commanded motion if the drive is compliant.
    pub journal: JournalMotion<T>,
    film_speed_m_s: T,
    /// Factor by which the effects of the lubricant scale the speed of the film.
    film_factor: T,
    /// Unsigned friction level that determines the deflection of a bristle, as a coefficient. For a
    /// law that deflects as a whole ([`Law::BENDS_WHOLE`]), it is the whole friction.
    magnitude: T,
    /// Unsigned part of the force that jumps when a rigid journal reverses, N.
    jump_n: T,
    /// Friction force of one bearing, N, before the effects of the instrument.
    pub force_n: T,
    /// Reading of the instrument (predicted recorded force), N.
    pub reading_n: T,
}

impl<T: Real, L: Law<T>> Chain<T, L, ()> {
    /// Creates a chain of a law without effects, on a linear axis.
    #[must_use]
    pub fn new(law: L) -> Self {
        Self {
            law,
            effects: (),
            rig: Rig::default(),
        }
    }
}

impl<T: Real, L, E> Chain<T, L, E> {
    /// Adds an effect.
    ///
    /// The effect acts at its own stage of the signal chain, so effects of different stages may be
    /// added in any order. Effects of one stage act in the order in which they are added.
    #[must_use]
    pub fn with<F: Effect<T>>(self, effect: F) -> Chain<T, L, (E, F)> {
        Chain {
            law: self.law,
            effects: (self.effects, effect),
            rig: self.rig,
        }
    }

    /// Replaces the effects by a set, such as the [`Effects`] selected from the catalogue by name.
    #[must_use]
    pub fn with_effects<F: Effect<T>>(self, effects: F) -> Chain<T, L, F> {
        Chain {
            law: self.law,
            effects,
            rig: self.rig,
        }
    }

    /// Places the chain on the shaft of a bearing instead of a linear axis.
    ///
    /// On a linear axis the angle of a motion is the position, m.
    #[must_use]
    pub fn on(self, bearing: &Bearing) -> Self {
        Self {
            rig: Rig::on(Some(bearing)),
            ..self
        }
    }
}

impl<T: Real, L: Law<T>, E: Effect<T>> Chain<T, L, E> {
    /// Returns the force that resists the drive, N per bearing: the friction, or the spring force
    /// of a compliant drive.
    #[inline]
    pub fn reaction_n(&self, state: &State<T, L::State, E>) -> Friction<T> {
        let (states, motion) = (&state.effects, &state.motion);
        let mut spring_n = None;
        self.effects
            .transmitted_n(states, motion, &self.rig, &mut spring_n);
        if let Some(smooth_n) = spring_n {
            return Friction {
                jump: T::ZERO,
                smooth: smooth_n,
            };
        }
        let direction = state.journal.direction;
        // Inside the backlash of a drive, no force of the journal is transmitted.
        let loose = self.effects.has_drive() && state.motion.velocity_m_s != T::ZERO;
        Friction {
            jump: if loose {
                state.jump_n * direction.abs()
            } else {
                state.jump_n
            },
            smooth: state.force_n - state.jump_n * direction,
        }
    }

    /// Velocity-dependent friction at `velocity_m_s` (m/s) relative to rest, without the part that
    /// jumps, N per bearing.
    ///
    /// The result contains the viscous friction of the law, as modified by the effects of the
    /// lubricant and the contact, and drags. It is zero with a compliant drive, which transmits
    /// only its spring force.
    #[inline]
    pub(crate) fn viscous_n(&self, state: &State<T, L::State, E>, velocity_m_s: T) -> T {
        if self.effects.has_drive() {
            return T::ZERO;
        }
        let still = JournalMotion {
            velocity_m_s: T::ZERO,
            ..state.journal
        };
        let moving = JournalMotion {
            velocity_m_s,
            direction: velocity_m_s.sign(),
            ..state.journal
        };
        let load_n = self.law.pressed_n(state.motion.load_n);
        let film_m_s = velocity_m_s * self.film_factor(state, &moving);
        let mut sliding = self.law.friction(&state.law, film_m_s);
        // The contact may have memory: evaluate it on a copy, in a step of zero length.
        let mut effects = state.effects;
        self.effects
            .contact(&mut effects, &moving, &moving, &mut sliding, T::ZERO);
        let other_n = |journal| {
            let (mut all_n, mut transmitted_n) = (Friction::NONE, T::ZERO);
            self.effects
                .add_friction(&state.effects, journal, &mut all_n, &mut transmitted_n);
            all_n.smooth
        };
        sliding.smooth * load_n + other_n(&moving) - other_n(&still)
    }

    /// Returns the state at the first sample of a run; `&Motion::default()` for a start at rest.
    pub fn start(&self, motion: &Motion<T>) -> State<T, L::State, E> {
        let journal = JournalMotion::from(motion);
        let mut state = State {
            law: self.law.start(motion.load_n),
            effects: self.effects.start(motion, &self.rig),
            motion: *motion,
            journal,
            film_speed_m_s: T::ZERO,
            film_factor: T::ONE,
            magnitude: T::ZERO,
            jump_n: T::ZERO,
            force_n: T::ZERO,
            reading_n: T::ZERO,
        };
        let factor = self.film_factor(&state, &journal);
        state.film_speed_m_s = journal.velocity_m_s.abs() * factor;
        state.film_factor = factor;
        let scaled = self.scaled(&mut state.effects, motion.load_n);
        let law = scaled.as_ref().unwrap_or(&self.law);
        if scaled.is_some() {
            state.law = law.start(motion.load_n);
        }
        self.act(law, &mut state, journal, factor, T::ZERO);
        state.reading_n = state.force_n;
        self.effects
            .first_reading(&mut state.effects, &mut state.reading_n);
        state
    }

    /// Advances the state to the motion `to`, `dt_s` later, and returns the force there, N, as the
    /// instrument measures it.
    ///
    /// Without effects of the instrument, this is the friction force of one bearing.
    ///
    /// A step shorter than 1e-12 s and a sample that is not finite do not change the
    /// state. A single invalid sample would otherwise remain in the state of a filter forever.
    #[inline(always)]
    pub fn step(&self, state: &mut State<T, L::State, E>, to: &Motion<T>, dt_s: T) -> T {
        if !(dt_s >= T::of(SHORTEST_STEP_S) && dt_s.is_finite() && to.is_finite()) {
            return state.reading_n;
        }
        let scaled = self.scaled(&mut state.effects, to.load_n);
        let law = scaled.as_ref().unwrap_or(&self.law);
        law.set_load(&mut state.law, to.load_n);
        let mut journal = JournalMotion::from(to);
        self.effects
            .drive(&mut state.effects, &self.rig, &mut journal, dt_s);
        let factor = self.film_factor(state, &journal);
        let end = journal.velocity_m_s.abs() * factor;
        let factors = state.film_factor + factor;
        let middle =
            (state.journal.velocity_m_s + journal.velocity_m_s).abs() * (T::of(0.25) * factors);
        let mut rate = T::ONE;
        self.effects.film_rate(&state.effects, &journal, &mut rate);
        let speed_m_s = [state.film_speed_m_s, middle, end];
        law.advance(&mut state.law, speed_m_s, rate, dt_s);
        (state.film_speed_m_s, state.film_factor) = (end, factor);
        state.motion = *to;
        let (from, begin_n, jump_n) = (state.journal, state.force_n, state.jump_n);
        self.act(law, state, journal, factor, dt_s);
        let mean = from.velocity_m_s + journal.velocity_m_s;
        // Under a rigid drive, breakaway from the static level takes no time.
        let from_rest = L::HAS_STATIC_LEVEL && from.direction == T::ZERO;
        let start_jump_n = if from_rest { state.jump_n } else { jump_n };
        let mut signal = Signal {
            begin_n: begin_n + start_jump_n * direction_change(from.direction, mean),
            end_n: state.force_n + state.jump_n * direction_change(journal.direction, mean),
            now_n: state.force_n,
        };
        self.effects
            .reading(&mut state.effects, &mut signal, to.time_s, dt_s);
        state.reading_n = signal.now_n;
        state.reading_n
    }

    /// Advances the state by `dt_s` to a speed (m/s, signed) and returns the force there, N, as
    /// [`Chain::step`].
    ///
    /// The acceleration and the angle follow from the speed, which changes linearly in the step. Load
    /// and temperature remain those of the last sample.
    #[inline]
    pub fn step_velocity(&self, state: &mut State<T, L::State, E>, velocity_m_s: T, dt_s: T) -> T {
        let before = &state.motion;
        let mean_m_s = (before.velocity_m_s + velocity_m_s) * T::of(0.5);
        let to = Motion {
            time_s: before.time_s + dt_s,
            velocity_m_s,
            acceleration_m_s2: (velocity_m_s - before.velocity_m_s) / dt_s,
            angle_rad: before.angle_rad + mean_m_s * dt_s / self.rig.radius_m,
            ..*before
        };
        self.step(state, &to, dt_s)
    }

    /// Returns the law scaled for the load `load_n`, if an effect scales the law.
    #[inline(always)]
    fn scaled(&self, states: &mut E::State, load_n: T) -> Option<L> {
        let mut scales = None;
        let share = self.law.load_share(load_n);
        self.effects.scales(states, &mut scales, share);
        self.law.scaled(&scales?)
    }

    /// Factor by which the effects of the lubricant scale the speed of the film.
    #[inline(always)]
    fn film_factor(&self, state: &State<T, L::State, E>, journal: &JournalMotion<T>) -> T {
        let mut factor = T::ONE;
        self.effects.lubricant(&state.effects, journal, &mut factor);
        factor
    }

    /// Computes the force from the state of the law: contact effects, other friction, and the
    /// feedback to the drive and the lubricant.
    #[inline(always)]
    fn act(
        &self,
        law: &L,
        state: &mut State<T, L::State, E>,
        journal: JournalMotion<T>,
        factor: T,
        dt_s: T,
    ) {
        let load_n = law.pressed_n(state.motion.load_n);
        let mut sliding = law.friction(&state.law, journal.velocity_m_s * factor);
        self.effects.contact(
            &mut state.effects,
            &state.journal,
            &journal,
            &mut sliding,
            dt_s,
        );
        let (mut other_n, mut transmitted_n) = (Friction::NONE, T::ZERO);
        self.effects
            .add_friction(&state.effects, &journal, &mut other_n, &mut transmitted_n);
        self.effects
            .transmission(&state.effects, &mut sliding, transmitted_n);
        // Friction that deflects a bristle, and friction that acts in parallel with it.
        let (magnitude, parallel) = if L::BENDS_WHOLE {
            (sliding.jump + sliding.smooth.abs(), T::ZERO)
        } else {
            (sliding.jump, sliding.smooth)
        };
        let before = if dt_s > T::ZERO {
            state.magnitude
        } else {
            magnitude
        };
        let levels = [before, magnitude];
        let bent = if L::HAS_BRISTLE {
            Some(law.bend(&mut state.law, &state.journal, &journal, levels, dt_s))
        } else {
            let (states, from) = (&mut state.effects, &state.journal);
            let mut deflected = None;
            self.effects
                .bristle(states, from, &journal, &mut deflected, levels, dt_s);
            deflected
        };
        let bent = bent.map(|bristle| bristle + parallel);
        let coefficient = bent.unwrap_or_else(|| sliding.along(journal.direction));
        // A bristle turns the jump of the contact into a slope.
        let contact_n = if bent.is_some() {
            T::ZERO
        } else {
            sliding.jump * load_n
        };
        state.jump_n = contact_n + other_n.jump;
        state.force_n = coefficient * load_n + other_n.jump * journal.direction + other_n.smooth;
        state.magnitude = magnitude;
        let speed = journal.velocity_m_s;
        if self.effects.has_drive() {
            let slope = if speed == T::ZERO {
                T::ZERO
            } else {
                (sliding.smooth * load_n / speed).max(T::ZERO)
            };
            let resistance = Resistance {
                level_n: sliding.jump * load_n + other_n.jump,
                slope_n_s_m: slope,
            };
            self.effects.resist(&mut state.effects, &resistance, dt_s);
        }
        // Only the film's own friction heats the film; a drag elsewhere does not.
        let power_w = (coefficient * load_n * speed).abs();
        self.effects.heat(&mut state.effects, power_w, dt_s);
        state.journal = journal;
    }
}

/// Change of the direction from inside a step to one of its ends, where the direction is
/// `direction`.
///
/// The direction inside a step is the sign of its mean speed. A rigid journal that starts, stops or
/// reverses at that end jumps. A journal held by a compliant drive passes through every direction
/// in between and never jumps.
#[inline(always)]
fn direction_change<T: Real>(direction: T, mean_speed_m_s: T) -> T {
    let inside = mean_speed_m_s.sign();
    if inside == T::ZERO || (direction != T::ZERO && direction != -inside) {
        T::ZERO
    } else {
        inside - direction
    }
}
