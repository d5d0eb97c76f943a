//! Play in the drive: turning round, the drive crosses a gap before it takes the journal along.
//!
//! ```text
//! th_j stands while th_m crosses the gap; at a flank it follows
//! ```
//!
//! The play operator of hysteresis (Brokate & Sprekels 1996). While the gap is crossed nothing
//! turns the journal: it stands, and the load cell sees no friction at all, for nothing but the
//! drive could hold a friction up. The film feels a journal at rest.
//!
//! The first motion of a run finds its flank closed. A step in which the flank closes shows the
//! part of it in which the journal was driven: the reading is then continuous in the gap, and
//! so has a slope for an optimiser.

use super::{Drive, Effect, Info, Need, Parameter, Resistance, Rig, Stage};
use crate::error::ParameterError;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// A gap between the drive's flanks.
#[derive(Clone, Copy, Debug)]
pub struct Backlash<T> {
    gap_rad: T,
}

/// Where in the gap the drive stands.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    /// Way from the middle of the gap, m: half the gap at the flank that drives forward. None
    /// before the first motion.
    place_m: Option<T>,
    /// The same where the run began to move, m: there the journal's angle was the drive's.
    first_m: T,
    /// Speed of the drive at the end of the last step, m/s.
    speed_m_s: T,
}

impl<T: Real> State<T> {
    /// The drive moves by `way_m`, signed; gives the part of the way that the journal goes along.
    #[inline(always)]
    fn advance(&mut self, way_m: T, half_m: T) -> T {
        if way_m == T::ZERO {
            return T::ONE;
        }
        let flank = if way_m > T::ZERO { half_m } else { -half_m };
        let Some(place) = self.place_m else {
            (self.place_m, self.first_m) = (Some(flank), flank);
            return T::ONE;
        };
        let there = place + way_m;
        if (flank - there) * way_m > T::ZERO {
            self.place_m = Some(there);
            return T::ZERO;
        }
        self.place_m = Some(flank);
        T::ONE - (flank - place) / way_m
    }
}

impl<T: Real> Effect<T> for Backlash<T> {
    const INFO: Info = Info {
        name: "backlash",
        stage: Stage::Drive,
        summary: "a gap in gear, key or coupling: after a turn the journal stands until it is \
                  crossed",
        equation: "th_j stands while th_m crosses the gap, friction 0; at a flank th_j' = th_m'",
        source: "Nordin & Gutman 2002; play operator: Brokate & Sprekels 1996",
        limits: "rigid flanks without a bounce; no drag in the gap; the first motion finds its \
                 flank closed; beside presliding the bristle keeps its force while the journal \
                 stands; on a linear axis the gap is in m",
        parameters: &[Parameter {
            name: "gap_rad",
            unit: "rad",
            meaning: "angle between the flanks",
            lower: 0.0,
            upper: 1.0,
            null: Some(0.0),
            starts: &[0.0215, 0.0043],
            log: false,
            period: None,
        }],
        needs: &[Need::NoBristle],
        longest_step_s: 0.02,
    };
    const MOVES_JUMPS: bool = true;
    type State = State<T>;

    fn new(parameters: &[T]) -> Result<Self, ParameterError> {
        Self::INFO.check(parameters)?;
        Ok(Self {
            gap_rad: parameters[0],
        })
    }

    fn start(&self, motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            place_m: None,
            first_m: T::ZERO,
            speed_m_s: motion.velocity_m_s,
        }
    }
}

impl<T: Real> Drive<T> for Backlash<T> {
    #[inline(always)]
    fn step(
        &self,
        state: &mut State<T>,
        to: &JournalMotion<T>,
        _resistance: &Resistance<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T> {
        let half_m = self.gap_rad * rig.radius_m * T::of(0.5);
        let (v0, v1) = (state.speed_m_s, to.velocity_m_s);
        state.speed_m_s = v1;
        let half_s = T::of(0.5) * dt_s;
        let mut driven = if v0.value() * v1.value() < 0.0 {
            // The speed crosses zero on a straight line: out, then back.
            let share = v0 / (v0 - v1);
            state.advance(v0 * share * half_s, half_m);
            state.advance(v1 * (T::ONE - share) * half_s, half_m)
        } else {
            state.advance((v0 + v1) * half_s, half_m)
        };
        let place = state.place_m.unwrap_or(T::ZERO);
        // At rest a soft drive may still push, but only through the flank that it leans on.
        if v1 == T::ZERO && to.direction != T::ZERO {
            let leans = place == half_m * to.direction.sign();
            driven = if leans { T::ONE } else { T::ZERO };
        }
        JournalMotion {
            velocity_m_s: v1 * driven,
            acceleration_m_s2: to.acceleration_m_s2 * driven,
            angle_rad: to.angle_rad - (place - state.first_m) / rig.radius_m,
            direction: to.direction * driven,
            time_s: to.time_s,
        }
    }
}
