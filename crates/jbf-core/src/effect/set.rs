//! A set of effects, as a chain holds it: none, one in its place, two sets beside each other, one
//! that may be there, or the whole catalogue. A typed set costs the memory and the time of the
//! effects in it, nothing more.
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

/// What stands round a law in a chain. Each method is one stage of the signal chain; what is handed
/// on from effect to effect goes through the argument that it changes. A set does nothing at the
/// stages where it has no effect.
pub trait EffectSet<T: Real>: Copy + Debug {
    /// What the effects remember.
    type State: Copy + Debug;

    /// The state at the start of a run.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;

    /// The longest inner step that suits every effect here, s.
    #[inline]
    fn longest_step_s(&self) -> f64 {
        f64::INFINITY
    }

    /// True where what an effect does depends on what was before: without it the steps between two
    /// samples change nothing at the second.
    #[inline]
    fn remembers(&self) -> bool {
        core::mem::size_of::<Self::State>() > 0
    }

    /// True where the journal may part from the commanded side.
    #[inline(always)]
    fn has_drive(&self) -> bool {
        false
    }

    /// Drive: the journal's motion at the end of the step.
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

    /// Drive: what holds the journal at the end of a step of `dt_s`, none at the start of a run.
    #[inline(always)]
    fn resist(&self, state: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        let _ = (state, resistance, dt_s);
    }

    /// Drive: what a soft one hands on to the commanded side, N a bearing.
    #[inline]
    fn transmitted_n(&self, state: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let _ = (state, motion, rig);
        None
    }

    /// Lubricant: the factor on the speed that the film feels.
    #[inline(always)]
    fn lubricant(&self, state: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        let _ = (state, journal, factor);
    }

    /// Lubricant: take the friction power, W, at the end of a step.
    #[inline(always)]
    fn warm(&self, state: &mut Self::State, power_w: T, dt_s: T) {
        let _ = (state, power_w, dt_s);
    }

    /// Load: the law's parameters under a load of `share` times the rig's; none where they stay as
    /// they are.
    #[inline(always)]
    fn scales(
        &self,
        state: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        let _ = (state, share, scales);
    }

    /// Lubricant and film: the factor on the film's clock.
    #[inline(always)]
    fn film_rate(&self, state: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        let _ = (state, journal, rate);
    }

    /// Film: the largest of its factors on the clock, at least one.
    #[inline]
    fn fastest_film(&self) -> f64 {
        1.0
    }

    /// Contact: advance over `dt_s` and change the sliding friction.
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

    /// Contact: change the sliding friction by what the drive's transmission carries, N.
    #[inline(always)]
    fn transmission(&self, state: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        let _ = (state, transmitted_n, sliding);
    }

    /// Contact: its coefficient, signed, through the bristle where there is one.
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

    /// Other friction: add it, N, and what of it the drive's transmission carries, N.
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

    /// Instrument: the first reading of a run, N.
    #[inline]
    fn first(&self, state: &mut Self::State, force_n: T) -> T {
        let _ = state;
        force_n
    }

    /// Instrument: the signal of a step of `dt_s` that ends at `time_s`.
    #[inline(always)]
    fn reading(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let _ = (state, time_s, dt_s);
        signal
    }
}

/// No effects: the bare law.
impl<T: Real> EffectSet<T> for () {
    type State = ();
    #[inline(always)]
    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}
