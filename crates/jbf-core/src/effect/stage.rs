//! Trait of effects, and the signals between the stages of the signal chain.

use super::Rig;
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::fmt::Debug;

/// Effect in a signal chain, or a set of effects.
///
/// Each method is a part of one stage of the signal chain. The default of each method leaves the
/// signals unchanged, so an effect has only the methods of its stage. Quantities that several
/// effects change in turn are mutable arguments.
///
/// The signal chain evaluates the stages in the order drive, lubricant, load, film, contact,
/// transmission, bristle, other, instrument. The catalogue lists load as film, and transmission and
/// bristle as contact.
///
/// An effect that implements [`drive`](Self::drive) must return true from
/// [`has_drive`](Self::has_drive); otherwise the chain does not call [`resist`](Self::resist). An
/// effect that raises the rate in [`film_rate`](Self::film_rate) must return its largest factor
/// from [`fastest_film`](Self::fastest_film), which limits the step; the dependence of the rate on
/// the recorded temperature is taken from the record.
///
/// Sets are composed of effects: `()` has no effect, `(A, B)` has the effects of `A` and then those
/// of `B` at every stage, `Option<A>` those of `A` or none, and [`Effects`](super::Effects) those
/// selected from the catalogue by name at run time. A set reserves memory for its own effects only.
pub trait Effect<T: Real>: Copy + Debug {
    /// Longest step with which the effect is sufficiently accurate, s.
    const LONGEST_STEP_S: f64 = 0.02;

    /// State of the effect in the course of a run; `()` for an effect without one.
    type State: Copy + Debug;

    /// Whether the effect depends on the past; by default if it has a state.
    const HAS_MEMORY: bool = core::mem::size_of::<Self::State>() > 0;

    /// Returns the state at the start of a run that begins with `motion`.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;

    /// Returns the longest step that every effect of a set allows, s.
    #[inline]
    fn longest_step_s(&self) -> f64 {
        Self::LONGEST_STEP_S
    }

    /// Returns true if an effect depends on the past.
    ///
    /// Otherwise the steps between two samples have no influence on the second sample.
    #[inline]
    fn has_memory(&self) -> bool {
        Self::HAS_MEMORY
    }

    /// Returns true if the motion of the journal may differ from the commanded motion, as it does
    /// with every effect that implements `drive`.
    #[inline(always)]
    fn has_drive(&self) -> bool {
        false
    }

    /// Stage drive: computes the motion of the journal at the end of the step from the commanded
    /// one.
    #[inline(always)]
    fn drive(
        &self,
        state: &mut Self::State,
        rig: &Rig<T>,
        journal: &mut JournalMotion<T>,
        dt_s: T,
    ) {
        let _ = (state, rig, journal, dt_s);
    }

    /// Stage drive: stores the resistance of the journal at the end of a step of `dt_s`, which is
    /// zero at the start of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }

    /// Stage drive: sets the force that a compliant drive transmits to the commanded side, N per
    /// bearing; it remains `None` for a rigid drive.
    #[inline(always)]
    fn transmitted_n(
        &self,
        state: &Self::State,
        motion: &Motion<T>,
        rig: &Rig<T>,
        force_n: &mut Option<T>,
    ) {
        let _ = (state, motion, rig, force_n);
    }

    /// Stage lubricant: multiplies `factor`, which scales the speed in the film equations.
    #[inline(always)]
    fn lubricant(&self, state: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        let _ = (state, journal, factor);
    }

    /// Stage lubricant: advances the temperature with the friction power (W) at the end of the
    /// step.
    #[inline(always)]
    fn heat(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }

    /// Stage load: sets the factors on the parameters of the law for a load of `share` times the
    /// nominal load of the rig.
    ///
    /// `scales` remains `None` if no effect depends on the load.
    #[inline(always)]
    fn scales(&self, state: &mut Self::State, scales: &mut Option<Scales<T>>, share: T) {
        let _ = (state, scales, share);
    }

    /// Stages lubricant and film: multiplies `rate`, which scales the rate of the film dynamics.
    #[inline(always)]
    fn film_rate(&self, state: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        let _ = (state, journal, rate);
    }

    /// Stage film: returns the largest factor by which `film_rate` multiplies the rate of the film
    /// dynamics, at least one.
    #[inline]
    fn fastest_film(&self) -> f64 {
        1.0
    }

    /// Stage contact: advances the effects by `dt_s` and changes the sliding friction, a
    /// coefficient.
    #[inline(always)]
    fn contact(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        let _ = (state, from, to, sliding, dt_s);
    }

    /// Stage transmission: changes the sliding friction, a coefficient, according to the force (N)
    /// that the transmission carries.
    #[inline(always)]
    fn transmission(&self, state: &Self::State, sliding: &mut Friction<T>, transmitted_n: T) {
        let _ = (state, sliding, transmitted_n);
    }

    /// Stage bristle: replaces the jump of friction at a reversal by the deflection of a bristle,
    /// after all other effects on the contact.
    ///
    /// Sets `deflected` to the signed friction coefficient; it remains `None` without a bristle.
    /// `magnitude` contains the sliding coefficients at the start and at the end of the step. A step
    /// of zero length is the start of a run.
    #[inline(always)]
    fn bristle(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        deflected: &mut Option<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) {
        let _ = (state, from, to, deflected, magnitude, dt_s);
    }

    /// Stages other and instrument: adds friction to `sum_n`, N, and the force that the
    /// transmission carries to `transmitted_n`, N. The offset of an instrument, for example, is part
    /// of the transmitted force.
    #[inline(always)]
    fn add_friction(
        &self,
        state: &Self::State,
        journal: &JournalMotion<T>,
        sum_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let _ = (state, journal, sum_n, transmitted_n);
    }

    /// Stage instrument: changes the force at the start of a run to the first reading, N.
    #[inline(always)]
    fn first_reading(&self, state: &mut Self::State, force_n: &mut T) {
        let _ = (state, force_n);
    }

    /// Stage instrument: changes the signal of a step of `dt_s` that ends at `time_s`.
    #[inline(always)]
    fn reading(&self, state: &mut Self::State, signal: &mut Signal<T>, time_s: T, dt_s: T) {
        let _ = (state, signal, time_s, dt_s);
    }
}

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
