//! Sets of effects in a signal chain.
//!
//! A set is empty, one effect in its adapter, a pair of sets, an optional set, or the whole
//! catalogue. A typed set requires memory and time only for its own effects.
//!
//! ```
//! use jbf_core::effect::{coulomb_drag::CoulombDrag, sensor_lag::SensorLag};
//! use jbf_core::effect::{Beside, InInstrument, Place};
//! let effects = (
//!     Beside::<CoulombDrag<f64>>::new(&[0.8])?,
//!     InInstrument::<SensorLag<f64>>::new(&[0.05])?,
//! );
//! # let _ = effects;
//! # Ok::<(), jbf_core::ParameterError>(())
//! ```

use super::{Resistance, Rig, Signal};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::fmt::Debug;

/// Set of effects before and after the law in a signal chain.
///
/// Each method is a part of one stage of the signal chain. Quantities that several effects change
/// in turn are mutable arguments. A set without an effect at a stage leaves them unchanged.
pub trait EffectSet<T: Real>: Copy + Debug {
    /// State of the effects in the course of a run.
    type State: Copy + Debug;

    /// Returns the state at the start of a run that begins with `motion`.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;

    /// Returns the longest step that every effect of the set allows, s.
    #[inline]
    fn longest_step_s(&self) -> f64 {
        f64::INFINITY
    }

    /// Returns true if an effect depends on the past.
    ///
    /// Otherwise the steps between two samples have no influence on the second sample.
    #[inline]
    fn remembers(&self) -> bool {
        core::mem::size_of::<Self::State>() > 0
    }

    /// Returns true if the motion of the journal may differ from the commanded motion.
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
        journal: &mut JournalMotion<T>,
        rig: &Rig<T>,
        dt_s: T,
    ) {
        let _ = (state, journal, rig, dt_s);
    }

    /// Stage drive: stores the resistance of the journal at the end of a step of `dt_s`, which is
    /// zero at the start of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }

    /// Stage drive: returns the force that a compliant drive transmits to the commanded side, N per
    /// bearing; `None` for a rigid drive.
    #[inline]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }

    /// Stage lubricant: multiplies `factor`, which scales the speed in the film equations.
    #[inline(always)]
    fn lubricant(&self, state: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        let _ = (state, journal, factor);
    }

    /// Stage lubricant: advances the temperature with the friction power (W) at the end of the
    /// step.
    #[inline(always)]
    fn warm(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }

    /// Stage film: sets the factors on the parameters of the law for a load of `share` times the
    /// nominal load of the rig.
    ///
    /// `scales` remains `None` if no effect depends on the load.
    #[inline(always)]
    fn scales(
        &self,
        state: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        let _ = (state, share, scales);
    }

    /// Stages lubricant and film: multiplies `rate`, which scales the rate of the film dynamics.
    #[inline(always)]
    fn film_rate(&self, state: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        let _ = (state, journal, rate);
    }

    /// Stage film: returns the largest factor on the rate of the film dynamics, at least one.
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

    /// Stage contact: changes the sliding friction, a coefficient, according to the force (N) that
    /// the transmission carries.
    #[inline(always)]
    fn transmission(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        let _ = (state, transmitted_n, sliding);
    }

    /// Stage contact: returns the signed friction coefficient with the deflection of a bristle;
    /// `None` without a bristle.
    #[inline(always)]
    fn bristle(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> Option<T> {
        let _ = (state, from, to, magnitude, dt_s);
        None
    }

    /// Stage other: adds friction to `all_n`, N, and the force that the transmission carries to
    /// `transmitted_n`, N.
    #[inline(always)]
    fn other(
        &self,
        state: &Self::State,
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let _ = (state, journal, all_n, transmitted_n);
    }

    /// Stage instrument: returns the first reading of a run, N, for the force `force_n`.
    #[inline]
    fn first(&self, state: &mut Self::State, force_n: T) -> T {
        let _ = state;
        force_n
    }

    /// Stage instrument: returns the output signal for a step of `dt_s` that ends at `time_s`.
    #[inline(always)]
    fn reading(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let _ = (state, time_s, dt_s);
        signal
    }
}

/// Set without effects: the base law.
impl<T: Real> EffectSet<T> for () {
    type State = ();
    #[inline(always)]
    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}
