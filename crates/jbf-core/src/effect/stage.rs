//! The stages of the signal chain: what an effect at each of them does. An effect has the trait of
//! its stage and [`Effect`]; it knows nothing of the other stages.

use super::{Effect, Rig};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// What holds the journal back, as the drive feels it: `level sgn(v) + slope v`, N a bearing.
///
/// A line over the speed, not [`Friction`] at one: a drive solves for the speed that the journal
/// will have, and must know what friction is at another than now.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<T> {
    /// Largest force that takes the sign of the motion, N.
    pub level_n: T,
    /// Slope of the part that grows with speed, N s/m.
    pub slope_n_s_m: T,
}

/// Between the encoder and the journal.
pub trait Drive<T: Real>: Effect<T> {
    /// Advance over `dt_s`, the motion that drives going to `to`, and give the motion that is
    /// passed on.
    fn step(
        &self,
        state: &mut Self::State,
        to: &JournalMotion<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T>;
    /// Take what holds the journal at the end of a step of `dt_s`, none at the start of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }
    /// The force that the commanded side feels where it is not the journal's friction, as a force
    /// on one bearing, N.
    #[inline(always)]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }
}

/// Changes the speed that the film feels (its viscosity).
pub trait Lubricant<T: Real>: Effect<T> {
    /// Factor on `Ub`.
    fn factor(&self, state: &Self::State, journal: &JournalMotion<T>) -> T;
    /// Factor on the film's clock.
    #[inline(always)]
    fn rate(&self, state: &Self::State, journal: &JournalMotion<T>) -> T {
        let _ = (state, journal);
        T::ONE
    }
    /// Advance over `dt_s`, at the end of which the friction power is `power_w`, W.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }
}

/// Changes the law's own parameters with the load.
pub trait Loading<T: Real>: Effect<T> {
    /// Factors under a load of `share` times the rig's; all one where `share` is one.
    fn scales(&self, state: &mut Self::State, share: T) -> Scales<T>;
}

/// Changes how fast the film follows.
pub trait Film<T: Real>: Effect<T> {
    /// Factor on the film's clock.
    fn rate(&self, state: &Self::State) -> T;
    /// The largest that factor will be, at least one.
    fn fastest(&self) -> f64;
}

/// Changes the friction between the surfaces.
pub trait Contact<T: Real>: Effect<T> {
    /// Change the sliding friction, a coefficient.
    fn apply(&self, state: &Self::State, journal: &JournalMotion<T>, sliding: &mut Friction<T>);
    /// Advance over `dt_s` before `apply`.
    #[inline(always)]
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        dt_s: T,
    ) {
        let _ = (state, from, to, dt_s);
    }
}

/// Friction of the drive's transmission under what it carries: gears, a screw.
pub trait Transmission<T: Real>: Effect<T> {
    /// Change the sliding friction under a transmitted force, N, positive where it takes a push in
    /// positive direction.
    fn apply(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>);
}

/// Replaces the sign of the motion by a deflection: the last step of the contact stage.
pub trait Bristle<T: Real>: Effect<T> {
    /// The coefficient at the start of a run: bent already where the run starts in motion.
    fn first(&self, state: &mut Self::State, journal: &JournalMotion<T>, magnitude: T) -> T;
    /// Advance over `dt_s`; the sliding coefficient goes from the first magnitude to the
    /// second. Gives the coefficient, signed.
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> T;
}

/// Friction that is not the bearing's.
pub trait OtherFriction<T: Real>: Effect<T> {
    /// The friction, N.
    fn friction_n(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T>;
}

/// The force during a step, as an instrument meets it.
///
/// Friction jumps where a rigid journal starts, stops or turns; what it is on the inside of the
/// step differs there from what it is at the sample, and an instrument with a memory must follow
/// the inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal<T> {
    /// Just after the beginning of the step, N.
    pub begin_n: T,
    /// Just before its end, N.
    pub end_n: T,
    /// At its end, N.
    pub now_n: T,
}

impl<T: Real> Signal<T> {
    /// The signal with a constant added.
    #[inline]
    pub fn shifted(self, by_n: T) -> Self {
        Self {
            begin_n: self.begin_n + by_n,
            end_n: self.end_n + by_n,
            now_n: self.now_n + by_n,
        }
    }
}

/// Between the force and its record.
pub trait Instrument<T: Real>: Effect<T> {
    /// Constant force in the readings, N, which a drive's transmission may carry.
    #[inline(always)]
    fn constant_n(&self) -> T {
        T::ZERO
    }

    /// The first reading of a run that begins with `force_n`.
    fn first(&self, state: &mut Self::State, force_n: T) -> T;
    /// What the instrument makes of the signal of a step of `dt_s` that ends at `time_s`.
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T>;
}
