//! Stages of the signal chain, with one or more traits each.
//!
//! An effect implements [`Effect`] and the trait of its stage. An effect does not depend on the
//! other stages.

use super::{Effect, Rig};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Resistance of the journal to the drive: `level sgn(v) + slope v`, N per bearing.
///
/// Unlike a [`Friction`], the resistance applies to more than one speed: a drive solves for the
/// future speed of the journal.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<T> {
    /// Largest force that has the sign of the motion, N.
    pub level_n: T,
    /// Slope of the force that is proportional to the speed, N s/m.
    pub slope_n_s_m: T,
}

/// Effect on the motion between the encoder and the journal.
pub trait Drive<T: Real>: Effect<T> {
    /// Advances the effect by `dt_s` to the motion `to` of its input, and returns the motion of its
    /// output.
    fn step(
        &self,
        state: &mut Self::State,
        to: &JournalMotion<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) -> JournalMotion<T>;
    /// Stores the resistance of the journal at the end of a step of `dt_s`, which is zero at the
    /// start of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }
    /// Returns the force on the commanded side, N per bearing; `None` if it equals the friction of
    /// the journal.
    #[inline(always)]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }
}

/// Effect on the viscosity of the film, which is equivalent to a factor on the speed.
pub trait Lubricant<T: Real>: Effect<T> {
    /// Returns the factor on the dimensionless speed `Ub`.
    fn factor(&self, state: &Self::State, journal: &JournalMotion<T>) -> T;
    /// Returns the factor on the rate of the film dynamics; the default is one.
    #[inline(always)]
    fn rate(&self, state: &Self::State, journal: &JournalMotion<T>) -> T {
        let _ = (state, journal);
        T::ONE
    }
    /// Advances the effect by `dt_s`; the friction power at the end of the step is `power_w`, W.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }
}

/// Effect of the load on the parameters of the law.
pub trait Loading<T: Real>: Effect<T> {
    /// Returns the factors on the parameters of the law for a load of `share` times the nominal
    /// load of the rig.
    ///
    /// All factors are one if `share` is one.
    fn scales(&self, state: &mut Self::State, share: T) -> Scales<T>;
}

/// Effect on the rate of the film dynamics.
pub trait Film<T: Real>: Effect<T> {
    /// Returns the factor on the rate of the film dynamics.
    fn rate(&self, state: &Self::State) -> T;
    /// Returns the largest factor on the rate of the film dynamics, at least one.
    fn fastest(&self) -> f64;
}

/// Effect on the sliding friction between the surfaces.
pub trait Contact<T: Real>: Effect<T> {
    /// Changes the sliding friction, a coefficient, at the end of a step.
    fn apply(&self, state: &Self::State, journal: &JournalMotion<T>, sliding: &mut Friction<T>);
    /// Advances the effect by `dt_s`, before `apply` is called.
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

/// Friction of the transmission (gears, a screw) that depends on the force it carries.
pub trait Transmission<T: Real>: Effect<T> {
    /// Changes the sliding friction, a coefficient, according to the transmitted force, N.
    ///
    /// The force is positive if the drive must push in the positive direction.
    fn apply(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>);
}

/// Effect that replaces the jump of friction at a reversal by a deflection, after all other effects
/// on the contact.
pub trait Bristle<T: Real>: Effect<T> {
    /// Returns the signed friction coefficient at the start of a run, fully deflected if the run
    /// starts in motion.
    fn first(&self, state: &mut Self::State, journal: &JournalMotion<T>, magnitude: T) -> T;
    /// Advances the bristle by `dt_s` and returns the signed friction coefficient.
    ///
    /// `magnitude` contains the sliding coefficients at the start and at the end of the step.
    fn step(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> T;
}

/// Friction in addition to that of the bearing.
pub trait OtherFriction<T: Real>: Effect<T> {
    /// Returns the friction force, N.
    fn friction_n(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T>;
}

/// Force in the course of a step, the input and output of an instrument.
///
/// Friction jumps when a rigid journal starts, stops or reverses. The friction inside the step then
/// differs from that at the sample, and an instrument with memory must follow the values inside the
/// step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signal<T> {
    /// Force immediately after the start of the step, N.
    pub begin_n: T,
    /// Force immediately before the end of the step, N.
    pub end_n: T,
    /// Force at the sample that ends the step, N.
    pub now_n: T,
}

impl<T: Real> Signal<T> {
    /// Returns the signal with a constant (N) added.
    #[inline]
    pub fn shifted(self, by_n: T) -> Self {
        Self {
            begin_n: self.begin_n + by_n,
            end_n: self.end_n + by_n,
            now_n: self.now_n + by_n,
        }
    }
}

/// Effect of the instrument, between the force and its record.
pub trait Instrument<T: Real>: Effect<T> {
    /// Returns the constant force in the readings, N, which the transmission of a drive may carry;
    /// the default is zero.
    #[inline(always)]
    fn constant_n(&self) -> T {
        T::ZERO
    }

    /// Returns the first reading of a run that begins with the force `force_n`, N.
    fn first(&self, state: &mut Self::State, force_n: T) -> T;
    /// Returns the output of the instrument for a step of `dt_s` that ends at `time_s`.
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T>;
}
