//! Sets of effects, as held by a chain.
//!
//! A set is empty, one effect in its adapter, a pair of sets, an optional set, or the whole
//! catalogue. A typed set costs only the memory and the time of its effects.
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

/// Effects around a law in a chain.
///
/// Each method is one stage of the signal chain. Quantities that pass from effect to effect are
/// mutable arguments. A set does nothing at the stages where it has no effect.
pub trait EffectSet<T: Real>: Copy + Debug {
    /// State of the effects.
    type State: Copy + Debug;

    /// Returns the state at the start of a run.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;

    /// Longest inner step that every effect here allows, s.
    #[inline]
    fn longest_step_s(&self) -> f64 {
        f64::INFINITY
    }

    /// True if an effect depends on the past. Otherwise the steps between two samples do not change
    /// the second.
    #[inline]
    fn remembers(&self) -> bool {
        core::mem::size_of::<Self::State>() > 0
    }

    /// True if the motion of the journal may differ from the commanded one.
    #[inline(always)]
    fn has_drive(&self) -> bool {
        false
    }

    /// Drive: computes the motion of the journal at the end of the step.
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

    /// Drive: takes the resistance of the journal at the end of a step of `dt_s`, zero at the start
    /// of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }

    /// Drive: force that a compliant drive transmits to the commanded side, N per bearing.
    #[inline]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }

    /// Lubricant: applies the factor on the speed that the film sees.
    #[inline(always)]
    fn lubricant(&self, state: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        let _ = (state, journal, factor);
    }

    /// Lubricant: takes the friction power, W, at the end of a step.
    #[inline(always)]
    fn warm(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }

    /// Load: scales the parameters of the law under a load of `share` times the rig's; leaves
    /// `scales` unset where they do not change.
    #[inline(always)]
    fn scales(
        &self,
        state: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        let _ = (state, share, scales);
    }

    /// Lubricant and film: applies the factor on the film's clock.
    #[inline(always)]
    fn film_rate(&self, state: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        let _ = (state, journal, rate);
    }

    /// Film: largest factor on the clock, at least one.
    #[inline]
    fn fastest_film(&self) -> f64 {
        1.0
    }

    /// Contact: advances over `dt_s` and changes the sliding friction.
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

    /// Contact: changes the sliding friction according to the force that the transmission carries,
    /// N.
    #[inline(always)]
    fn transmission(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        let _ = (state, transmitted_n, sliding);
    }

    /// Contact: signed coefficient through the bristle; `None` without a bristle.
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

    /// Other friction: adds it to `all_n`, N, and the part that the transmission carries to
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

    /// Instrument: first reading of a run, N.
    #[inline]
    fn first(&self, state: &mut Self::State, force_n: T) -> T {
        let _ = state;
        force_n
    }

    /// Instrument: output signal for a step of `dt_s` that ends at `time_s`.
    #[inline(always)]
    fn reading(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let _ = (state, time_s, dt_s);
        signal
    }
}

/// No effects: the base law.
impl<T: Real> EffectSet<T> for () {
    type State = ();
    #[inline(always)]
    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}
