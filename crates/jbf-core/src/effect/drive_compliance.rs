//! Compliant drive: the motion of the encoder side is imposed, and a spring and a damper connect
//! the journal to it.
//!
//! ```text
//! J theta_j'' = k (theta_m - theta_j) + c (theta_m' - theta_j') - n R F(theta_j')
//! ```
//!
//! F is set-valued at rest: the journal sticks while the torque of the spring is below the sliding
//! friction, and the load cell then measures the torque of the spring.
//!
//! The force of a drive ([`Rig::force_at_drive`]) is measured ahead of the spring. With the effect
//! `inertia`, J is the part of its mass that is behind the spring, and must be smaller. Without
//! `inertia`, the force does not contain that of J. The force is
//!
//! ```text
//! T = (m_e - J) theta_m'' + J theta_j'' + F(theta_j')
//! ```
//!
//! A linear axis is treated as a shaft of radius 1 m: k is then in N/m, c in N s/m, J in kg.
//!
//! Source: Cohn (1998), section 5.1 and Figures 5.1, 5.4, 5.7, 5.10; Harnoy et al. (1994). The
//! integration method is the midpoint rule with an implicit solution for the set-valued force (a
//! proximal step, after Moreau), which allows sticking without chattering. If the steps resolve the oscillation of
//! the journal, a step in which it stops is divided there.

use super::registry::named_effect;
use super::{Effect, Info, Need, Resistance, Rig, Stage};
use crate::described::described;
use crate::motion::{sag, JournalMotion, Motion};
use crate::real::Real;

/// Largest number of integration steps per step of the chain.
///
/// In a step of 5 ms, they resolve the oscillation of a journal without friction up to 230 Hz. The
/// midpoint rule is also stable for a stiffer drive, but its oscillation is not resolved.
pub(crate) const MOST_INNER_STEPS: f64 = 24.0;

/// Longest integration step, relative to sqrt(J/k).
pub(crate) const LONGEST_INNER_STEP: f64 = 0.3;

/// Shortest previous step from which a change of the resistance is extrapolated, s.
pub(crate) const SHORTEST_STEP_S: f64 = 1e-12;

/// Spring and damper between the encoder and the inertia of the journal.
#[derive(Clone, Copy, Debug)]
pub struct DriveCompliance<T> {
    stiffness_n_m_rad: T,
    damping_n_m_s_rad: T,
    inertia_kg_m2: T,
    /// Longest integration step, s: a fraction of the period of a journal without friction.
    inner_step_s: f64,
}

/// Angle and speed of the journal, the motion of the encoder side, and the resistance of the
/// journal.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    angle_rad: T,
    speed_rad_s: T,
    encoder_rad: T,
    encoder_m_s: T,
    /// Resistance of the journal after the last step.
    ///
    /// `before` is the resistance one step (`step_before_s`) earlier.
    resistance: Resistance<T>,
    before: Resistance<T>,
    step_before_s: f64,
}

impl<T: Real> State<T> {
    /// Resistance at a `share` of a step after the last one, extrapolated linearly.
    #[inline(always)]
    fn ahead(&self, share: f64) -> Resistance<T> {
        let on = |a: T, b: T| (b + (b - a) * T::of(share)).max(T::ZERO);
        let (before, now) = (&self.before, &self.resistance);
        Resistance {
            level_n: on(before.level_n, now.level_n),
            slope_n_s_m: on(before.slope_n_s_m, now.slope_n_s_m),
        }
    }
}

described! {
    named_effect DriveCompliance = Info::new::<T, Self>("drive_compliance", Stage::Drive)
        .summary("elasticity of a belt, coupling or shaft between encoder and journal")
        .equation("J th_j'' = k (th_m - th_j) + c (th_m' - th_j') - n R F(th_j')")
        .source("Cohn 1998, section 5.1; Harnoy et al. 1994")
        .limits(
            "one spring, one inertia; higher torsional modes are not included; on a linear axis \
             k is in N/m, c in N s/m, J in kg; at a drive, the position is that of the motor, and J \
             is the part of inertia.m_e behind the spring",
        )
        .needs(&[Need::Path, Need::NoBristle]);
    k = "k", "N m/rad", "torsional stiffness between encoder and journal",
        [0.1, 1e7], [60.0, 600.0] null(f64::INFINITY) .log();
    c = "c", "N m s/rad", "damping in parallel to the spring",
        [1e-5, 1e3], [0.1] .log();
    j = "J", "kg m^2", "inertia of the driven side",
        [1e-6, 1e2], [2e-3] .log();
}

/// Direction of the friction of a journal with this speed; at rest that of the force `pull`, zero if
/// the sliding friction `hold` exceeds it.
#[inline(always)]
fn direction_from<T: Real>(speed: T, pull: T, hold: T) -> T {
    if speed != T::ZERO {
        speed.sign()
    } else if pull.abs() > hold {
        pull.sign()
    } else {
        T::ZERO
    }
}

impl<T: Real> DriveCompliance<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        let (k, j) = (p.k.value(), p.j.value());
        Self {
            stiffness_n_m_rad: p.k,
            damping_n_m_s_rad: p.c,
            inertia_kg_m2: p.j,
            inner_step_s: LONGEST_INNER_STEP * crate::root::sqrt(j / k),
        }
    }

    /// Returns the motion of the journal at the end of a step to the motion `to` of the encoder.
    #[inline(always)]
    fn step(
        &self,
        state: &mut State<T>,
        to: &JournalMotion<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T> {
        // The resistance depends on the motion of the journal and is extrapolated.
        let share = (dt_s.value() / state.step_before_s).min(1.0);
        let (middle, end) = (state.ahead(0.5 * share), state.ahead(share));
        let arm = rig.count * rig.radius_m;
        let inverse_radius = T::ONE / rig.radius_m;
        let hold = arm * middle.level_n;
        let slope = arm * rig.radius_m * middle.slope_n_s_m;
        let needed = libm::ceil(dt_s.value() / self.inner_step_s);
        let steps = needed.clamp(1.0, MOST_INNER_STEPS);
        let inverse_steps = 1.0 / steps;
        let h = dt_s.times(inverse_steps);
        let half = h.times(0.5);
        let (k, c) = (self.stiffness_n_m_rad, self.damping_n_m_s_rad);
        // Whether the steps resolve the oscillation of a journal without friction, and its decay.
        let resolved =
            needed <= MOST_INNER_STEPS && c.value() * h.value() <= self.inertia_kg_m2.value();
        // Sum of all coefficients of the midpoint speed.
        let inertia = self.inertia_kg_m2.times(2.0) / h;
        let inverse_drag = T::ONE / (inertia + k * half + c + slope);
        // Force of the encoder side along its path: the initial value, the linear change, and the
        // reduction by the curvature of the path.
        let change_m_s = to.velocity_m_s - state.encoder_m_s;
        let first = c * (state.encoder_m_s * inverse_radius);
        let line = k * (to.angle_rad - state.encoder_rad) + c * (change_m_s * inverse_radius);
        let bend = k * (change_m_s * dt_s * inverse_radius);
        let from = state.angle_rad - state.encoder_rad;
        let mut ahead = from;
        let mut direction = T::ZERO;
        let mut change_rad_s = T::ZERO;
        for i in 0..steps as u32 {
            let share = (f64::from(i) + 0.5) * inverse_steps;
            let pushed = first + line.times(share) - bend.times(sag(share));
            let pull = pushed - k * ahead;
            let before = state.speed_rad_s;
            direction = direction_from(before, pull, hold);
            if direction == T::ZERO {
                change_rad_s = T::ZERO;
                continue;
            }
            let speed = (inertia * before + pull - hold * direction) * inverse_drag;
            let after = speed + speed - before;
            if after.value() * direction.value() >= 0.0 {
                ahead += speed * h;
                change_rad_s = after - before;
                state.speed_rad_s = after;
                continue;
            }
            // The journal stops within the step.
            change_rad_s = -before;
            state.speed_rad_s = T::ZERO;
            if !resolved {
                if speed.value() * direction.value() > 0.0 {
                    ahead += speed * h;
                }
                continue;
            }
            // For the remaining time it moves on from rest, or sticks.
            let stopping = before / (before - after);
            let remaining = h - stopping * h;
            ahead += before * (stopping * h).times(0.5);
            direction = direction_from(T::ZERO, pull, hold);
            if direction != T::ZERO && remaining > T::ZERO {
                let drag = self.inertia_kg_m2.times(2.0) / remaining;
                let drag = drag + k * remaining.times(0.5) + c + slope;
                let speed = (pull - hold * direction) / drag;
                ahead += speed * remaining;
                state.speed_rad_s = speed + speed;
            }
        }
        // A stuck journal keeps its position exactly.
        if ahead != from {
            state.angle_rad = state.encoder_rad + ahead;
        }
        let slip_rad_s = to.velocity_m_s * inverse_radius - state.speed_rad_s;
        let torque = k * (to.angle_rad - state.angle_rad) + c * slip_rad_s;
        let hold = arm * end.level_n;
        let friction = if direction == T::ZERO {
            // Stuck: the friction equals the torque that holds the journal, if it suffices.
            let held = torque.max(-hold).min(hold);
            if hold > T::ZERO {
                direction = held / hold;
            }
            held
        } else {
            let slope = arm * rig.radius_m * end.slope_n_s_m;
            hold * direction + slope * state.speed_rad_s
        };
        // By the equation of motion at the end of the step. The change of the speed is that in the
        // middle of the last step, but remains bounded where the oscillation is not resolved.
        let acceleration_rad_s2 = if resolved {
            (torque - friction) / self.inertia_kg_m2
        } else {
            change_rad_s / h
        };
        let acceleration_m_s2 = acceleration_rad_s2 * rig.radius_m;
        (state.encoder_rad, state.encoder_m_s) = (to.angle_rad, to.velocity_m_s);
        let (measured_acceleration_m_s2, spring_inertia_n) = if rig.force_at_drive {
            let difference_m_s2 = acceleration_m_s2 - to.acceleration_m_s2;
            let mass_kg = self.inertia_kg_m2 / (arm * rig.radius_m);
            (to.acceleration_m_s2, mass_kg * difference_m_s2)
        } else {
            (acceleration_m_s2, T::ZERO)
        };
        JournalMotion {
            velocity_m_s: state.speed_rad_s * rig.radius_m,
            acceleration_m_s2,
            measured_acceleration_m_s2,
            spring_inertia_n,
            angle_rad: state.angle_rad,
            weight_offset_rad: to.weight_offset_rad,
            direction,
            time_s: to.time_s,
            load_n: to.load_n,
            temperature_c: to.temperature_c,
        }
    }
}

impl<T: Real> Effect<T> for DriveCompliance<T> {
    type State = State<T>;
    const LONGEST_STEP_S: f64 = 0.005;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> State<T> {
        let free = Resistance {
            level_n: T::ZERO,
            slope_n_s_m: T::ZERO,
        };
        State {
            angle_rad: motion.angle_rad,
            speed_rad_s: motion.velocity_m_s / rig.radius_m,
            encoder_rad: motion.angle_rad,
            encoder_m_s: motion.velocity_m_s,
            resistance: free,
            before: free,
            step_before_s: SHORTEST_STEP_S,
        }
    }

    #[inline(always)]
    fn has_drive(&self) -> bool {
        true
    }

    #[inline(always)]
    fn drive(&self, state: &mut State<T>, rig: &Rig<T>, journal: &mut JournalMotion<T>, dt_s: T) {
        *journal = self.step(state, journal, rig, dt_s);
    }

    #[inline(always)]
    fn resist(&self, state: &mut State<T>, resistance: &Resistance<T>, dt_s: T) {
        // At the start of a run the resistance is taken as unchanged.
        state.before = if dt_s > T::ZERO {
            state.resistance
        } else {
            *resistance
        };
        state.step_before_s = dt_s.value().max(SHORTEST_STEP_S);
        state.resistance = *resistance;
    }

    #[inline(always)]
    fn transmitted_n(
        &self,
        state: &State<T>,
        motion: &Motion<T>,
        rig: &Rig<T>,
        force_n: &mut Option<T>,
    ) {
        let twist = motion.angle_rad - state.angle_rad;
        let slip = motion.velocity_m_s / rig.radius_m - state.speed_rad_s;
        let torque_n_m = self.stiffness_n_m_rad * twist + self.damping_n_m_s_rad * slip;
        *force_n = Some(torque_n_m / (rig.count * rig.radius_m));
    }
}
