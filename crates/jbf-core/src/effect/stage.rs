//! Stages of the signal chain, one trait for each.
//!
//! An effect implements the trait of its stage and [`Effect`]; it does not depend on the other
//! stages.

use super::{Effect, Rig};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Resistance of the journal to the drive: `level sgn(v) + slope v`, N per bearing.
///
/// It is linear in the speed instead of a [`Friction`] at one speed. A drive solves for the future
/// speed of the journal and needs the friction at speeds other than the present one.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<T> {
    /// Largest force that takes the sign of the motion, N.
    pub level_n: T,
    /// Slope of the part that grows with speed, N s/m.
    pub slope_n_s_m: T,
}

/// Effect between the encoder and the journal.
pub trait Drive<T: Real>: Effect<T> {
    /// Advances over `dt_s` to the driving motion `to`, and returns the motion that is passed on.
    fn step(
        &self,
        state: &mut Self::State,
        to: &JournalMotion<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T>;
    /// Takes the resistance of the journal at the end of a step of `dt_s`, zero at the start of a
    /// run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }
    /// Force on the commanded side, as a force on one bearing, N; `None` where it is the friction
    /// of the journal.
    #[inline(always)]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }
}

/// Effect on the speed that the film sees (its viscosity).
pub trait Lubricant<T: Real>: Effect<T> {
    /// Factor on `Ub`.
    fn factor(&self, state: &Self::State, journal: &JournalMotion<T>) -> T;
    /// Factor on the film's clock.
    #[inline(always)]
    fn rate(&self, state: &Self::State, journal: &JournalMotion<T>) -> T {
        let _ = (state, journal);
        T::ONE
    }
    /// Advances over `dt_s`, at the end of which the friction power is `power_w`, W.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }
}

/// Effect of the load on the parameters of the law.
pub trait Loading<T: Real>: Effect<T> {
    /// Factors under a load of `share` times the rig's; all one where `share` is one.
    fn scales(&self, state: &mut Self::State, share: T) -> Scales<T>;
}

/// Effect on the response time of the film.
pub trait Film<T: Real>: Effect<T> {
    /// Factor on the film's clock.
    fn rate(&self, state: &Self::State) -> T;
    /// Largest factor on the film's clock, at least one.
    fn fastest(&self) -> f64;
}

/// Effect on the friction between the surfaces.
pub trait Contact<T: Real>: Effect<T> {
    /// Changes the sliding friction, a coefficient.
    fn apply(&self, state: &Self::State, journal: &JournalMotion<T>, sliding: &mut Friction<T>);
    /// Advances over `dt_s` before `apply`.
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

/// Friction of the drive's transmission (gears, a screw) under the force that it carries.
pub trait Transmission<T: Real>: Effect<T> {
    /// Changes the sliding friction under a transmitted force, N, which is positive where it
    /// requires a push in positive direction.
    fn apply(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>);
}

/// Effect that replaces the sign of the motion by a deflection: the last step of the contact stage.
pub trait Bristle<T: Real>: Effect<T> {
    /// Coefficient at the start of a run; fully deflected if the run starts in motion.
    fn first(&self, state: &mut Self::State, journal: &JournalMotion<T>, magnitude: T) -> T;
    /// Advances over `dt_s` and returns the signed coefficient.
    ///
    /// The sliding coefficient goes from the first magnitude to the second.
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> T;
}

/// Friction other than that of the bearing.
pub trait OtherFriction<T: Real>: Effect<T> {
    /// Friction force, N.
    fn friction_n(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T>;
}

/// Force during a step, as seen by an instrument.
///
/// Friction jumps where a rigid journal starts, stops or reverses. The friction inside the step
/// then differs from that at the sample, and an instrument with memory must follow the values
/// inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal<T> {
    /// Force just after the beginning of the step, N.
    pub begin_n: T,
    /// Force just before the end of the step, N.
    pub end_n: T,
    /// Force at the end of the step, N.
    pub now_n: T,
}

impl<T: Real> Signal<T> {
    /// Signal with a constant added.
    #[inline]
    pub fn shifted(self, by_n: T) -> Self {
        Self {
            begin_n: self.begin_n + by_n,
            end_n: self.end_n + by_n,
            now_n: self.now_n + by_n,
        }
    }
}

/// Effect between the force and its record.
pub trait Instrument<T: Real>: Effect<T> {
    /// Constant force in the readings, N, which a drive's transmission may carry.
    #[inline(always)]
    fn constant_n(&self) -> T {
        T::ZERO
    }

    /// First reading of a run that begins with `force_n`.
    fn first(&self, state: &mut Self::State, force_n: T) -> T;
    /// Output signal of the instrument for a step of `dt_s` that ends at `time_s`.
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T>;
}
