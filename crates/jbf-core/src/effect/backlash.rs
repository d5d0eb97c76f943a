//! Backlash in the drive: after a reversal the drive crosses a gap before it moves the journal.
//!
//! ```text
//! th_j is constant while th_m crosses the gap; th_j follows th_m at a flank
//! ```
//!
//! This is the play operator of hysteresis (Brokate & Sprekels 1996). While the drive crosses the
//! gap, the journal is at rest, and the load cell measures no friction, because only the drive
//! could balance friction.
//!
//! At the first motion of a run, the flank in the direction of the motion is in contact. The
//! friction rises linearly over one step, which is centred on the instant of contact. The predicted
//! force is then a continuous function of the size of the gap, and its derivative is available to
//! an optimiser.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::motion::{crossing, JournalMotion, Motion};
use crate::real::Real;

/// Backlash in the drive: a gap between two flanks.
#[derive(Clone, Copy, Debug)]
pub struct Backlash<T> {
    gap_rad: T,
}

/// Position of the drive in the gap, and the flank that is in contact.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    /// Distance of the drive from the middle of the gap, m: half the gap at the flank that drives
    /// forward.
    place_m: T,
    /// Flank in contact: +1 drives forward, -1 backward; 0 inside the gap.
    closed: i8,
    /// True after the first motion of the run.
    begun: bool,
    /// Value of `place_m` at the first motion, at which the angles of journal and drive were equal.
    first_m: T,
    /// Speed of the drive at the end of the last step, m/s.
    speed_m_s: T,
}

impl<T: Real> State<T> {
    /// Moves the drive by the signed distance `way_m` in a gap of half width `half_m`.
    ///
    /// Returns the weight of the drive's motion in that of the journal: 0 for a journal at rest, 1
    /// for one that follows the drive.
    #[inline(always)]
    fn advance(&mut self, way_m: T, half_m: T) -> T {
        let ahead = if way_m > T::ZERO { 1 } else { -1 };
        let flank = if way_m > T::ZERO { half_m } else { -half_m };
        if !self.begun && way_m != T::ZERO {
            (self.begun, self.closed) = (true, ahead);
            (self.place_m, self.first_m) = (flank, flank);
        }
        if self.closed == ahead || way_m == T::ZERO {
            return T::ONE;
        }
        let there = self.place_m + way_m;
        let beyond = (there - flank) / way_m;
        let closes = beyond.value() >= 0.0;
        self.closed = if closes { ahead } else { 0 };
        self.place_m = if closes { flank } else { there };
        // Half a step early, so that the middle of the ramp is where the flank closes. A gap
        // smaller than a step has no room for it.
        let early = (half_m + half_m).min(way_m.abs()) * T::of(0.5) / way_m.abs();
        let share = beyond + early;
        if share.value() > 1.0 {
            T::ONE
        } else {
            share.max(T::ZERO)
        }
    }
}

described! {
    named_effect Backlash = Info::new::<T, Self>("backlash", Stage::Drive)
        .summary(
            "play in gear, key or coupling: after a reversal the driven side rests until the \
             gap is crossed",
        )
        .equation("th_j constant while th_m crosses the gap, friction 0; at a flank th_j' = th_m'")
        .source("Nordin & Gutman 2002; play operator: Brokate & Sprekels 1996")
        .limits(
            "rigid flanks without rebound; no drag in the gap, and no inertia behind it; the first \
             motion starts at its flank; a presliding bristle keeps its force while the driven \
             side rests; on a linear axis the gap is in m",
        )
        .needs(&[Need::NoBristle]);
    // A gap that is crossed within a few samples is found only from a start value as small.
    gap = "gap", "rad", "angle between the flanks",
        [0.0, 1.0], [0.0215, 0.0043, 0.000_86] null(0.0);
}

impl<T: Real> Backlash<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self { gap_rad: p.gap }
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
        let half_m = self.gap_rad * rig.radius_m * T::of(0.5);
        let (v0, v1) = (state.speed_m_s, to.velocity_m_s);
        state.speed_m_s = v1;
        let half_s = T::of(0.5) * dt_s;
        let mut driven = if let Some(share) = crossing(v0, v1) {
            // First in the old direction, then back.
            state.advance(v0 * share * half_s, half_m);
            state.advance(v1 * (T::ONE - share) * half_s, half_m)
        } else {
            state.advance((v0 + v1) * half_s, half_m)
        };
        // At rest a compliant drive may still push, but only through the flank that it presses on.
        if v1 == T::ZERO && to.direction != T::ZERO {
            let leans = state.closed == if to.direction > T::ZERO { 1 } else { -1 };
            driven = if leans { T::ONE } else { T::ZERO };
        }
        let acceleration_m_s2 = to.acceleration_m_s2 * driven;
        JournalMotion {
            velocity_m_s: v1 * driven,
            acceleration_m_s2,
            measured_acceleration_m_s2: if rig.force_at_drive {
                to.measured_acceleration_m_s2
            } else {
                acceleration_m_s2
            },
            spring_inertia_n: to.spring_inertia_n,
            angle_rad: to.angle_rad - (state.place_m - state.first_m) / rig.radius_m,
            weight_offset_rad: to.weight_offset_rad,
            direction: to.direction * driven,
            time_s: to.time_s,
            load_n: to.load_n,
            temperature_c: to.temperature_c,
        }
    }
}

impl<T: Real> Effect<T> for Backlash<T> {
    type State = State<T>;

    fn start(&self, motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            place_m: T::ZERO,
            closed: 0,
            begun: false,
            first_m: T::ZERO,
            speed_m_s: motion.velocity_m_s,
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
}
