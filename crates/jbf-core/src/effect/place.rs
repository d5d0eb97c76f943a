//! Adapters that convert one effect to a set of effects, and determine how each stage of the signal
//! chain calls the effect.
//!
//! The effects of the catalogue use these adapters, and user-defined effects can use them too. In
//! another crate, write a type with [`Effect`](super::Effect) and the trait of its stage, and wrap
//! it:
//!
//! ```ignore
//! let effects = Effects::NONE.with(Beside::<MyWiper<f64>>::new(&[0.5])?);
//! ```
//!
//! `cargo run --example user_effect` shows a complete example.

use super::{
    Bristle, Contact, Drive, EffectSet, Film, Info, Instrument, Loading, Lubricant, OtherFriction,
    Resistance, Rig, Signal, Stage, Transmission,
};
use crate::error::{check, ParameterError};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Adapter of an effect for one stage of the signal chain.
pub trait Place<T: Real>: EffectSet<T> {
    /// Description of the wrapped effect.
    const INFO: Info;

    /// Creates the effect from its parameters, in the order of its description, and wraps it.
    ///
    /// # Errors
    /// Reports the first parameter that is missing, out of its bounds, or at an infinite null. In
    /// the last case the effect must be omitted.
    fn new(parameters: &[T]) -> Result<Self, ParameterError>;
}

/// Defines the adapters from their names, the trait of their effects, and the required stage in the
/// description of an effect.
///
/// The stage is checked at compile time.
macro_rules! places {
    ($($(#[$doc:meta])* $Place:ident: $Trait:ident at $stage:pat,)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub struct $Place<E>(pub E);

        impl<T: Real, E: $Trait<T>> Place<T> for $Place<E> {
            const INFO: Info = {
                assert!(
                    matches!(E::INFO.stage, $stage),
                    "the stage of the effect's description differs from the stage of its place"
                );
                E::INFO
            };

            fn new(parameters: &[T]) -> Result<Self, ParameterError> {
                let info = <Self as Place<T>>::INFO;
                for (page, value) in info.parameters.iter().zip(parameters) {
                    let infinite = page.null.is_some_and(|null| !null.is_finite());
                    check(
                        !infinite || page.null != Some(value.value()),
                        page.name,
                        value.value(),
                        "is the value at which the effect vanishes: omit the effect",
                    )?;
                }
                E::new(parameters).map(Self)
            }
        }
    )*};
}

places! {
    /// Adapter of an effect on the motion between encoder and journal.
    InDrive: Drive at Stage::Drive,
    /// Adapter of an effect on the viscosity of the oil.
    InLubricant: Lubricant at Stage::Lubricant,
    /// Adapter of an effect of the load on the parameters of the law.
    UnderLoad: Loading at Stage::Film,
    /// Adapter of an effect on the dynamics of the film.
    InFilm: Film at Stage::Film,
    /// Adapter of an effect on the friction between the surfaces.
    InContact: Contact at Stage::Contact,
    /// Adapter of an effect of the transmitted force on the friction, after the other effects on
    /// the contact.
    InTransmission: Transmission at Stage::Contact,
    /// Adapter of an effect that replaces the jump at a reversal by a deflection, after all other
    /// effects on the contact.
    AsBristle: Bristle at Stage::Contact,
    /// Adapter of an effect that adds a friction force to that of the bearing.
    Beside: OtherFriction at Stage::Other,
    /// Adapter of an effect of the instrument, between the force and its record.
    InInstrument: Instrument at Stage::Instrument,
}

impl<T: Real, E: Drive<T>> EffectSet<T> for InDrive<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        true
    }
    #[inline(always)]
    fn drive(&self, s: &mut Self::State, journal: &mut JournalMotion<T>, rig: &Rig<T>, dt_s: T) {
        *journal = self.0.step(s, journal, rig, dt_s);
    }
    #[inline(always)]
    fn resist(&self, s: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        self.0.resist(s, resistance, dt_s);
    }
    #[inline]
    fn transmitted_n(&self, s: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        self.0.transmitted_n(s, motion, rig)
    }
}

impl<T: Real, E: Lubricant<T>> EffectSet<T> for InLubricant<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn lubricant(&self, s: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        *factor *= self.0.factor(s, journal);
    }
    #[inline(always)]
    fn film_rate(&self, s: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        *rate *= self.0.rate(s, journal);
    }
    #[inline(always)]
    fn warm(&self, s: &mut Self::State, power_w: T, dt_s: T) {
        self.0.step(s, power_w, dt_s);
    }
}

impl<T: Real, E: Loading<T>> EffectSet<T> for UnderLoad<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn scales(
        &self,
        s: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        let own = self.0.scales(s, share());
        let before = scales.unwrap_or(Scales {
            transition_speed: T::ONE,
            stiffness: T::ONE,
        });
        *scales = Some(Scales {
            transition_speed: before.transition_speed * own.transition_speed,
            stiffness: before.stiffness * own.stiffness,
        });
    }
}

impl<T: Real, E: Film<T>> EffectSet<T> for InFilm<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn film_rate(&self, s: &Self::State, _journal: &JournalMotion<T>, rate: &mut T) {
        *rate *= self.0.rate(s);
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.0.fastest()
    }
}

impl<T: Real, E: Contact<T>> EffectSet<T> for InContact<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn contact(
        &self,
        s: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        self.0.step(s, from, to, dt_s);
        self.0.apply(s, to, sliding);
    }
}

impl<T: Real, E: Transmission<T>> EffectSet<T> for InTransmission<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn transmission(&self, s: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        self.0.apply(s, transmitted_n, sliding);
    }
}

impl<T: Real, E: Bristle<T>> EffectSet<T> for AsBristle<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn bristle(
        &self,
        s: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> Option<T> {
        Some(if dt_s > T::ZERO {
            self.0.step(s, from, to, magnitude, dt_s)
        } else {
            self.0.first(s, to, magnitude[1])
        })
    }
}

impl<T: Real, E: OtherFriction<T>> EffectSet<T> for Beside<E> {
    type State = E::State;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline(always)]
    fn other(
        &self,
        s: &Self::State,
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let own_n = self.0.friction_n(s, journal);
        all_n.jump += own_n.jump;
        all_n.smooth += own_n.smooth;
        if <Self as Place<T>>::INFO.transmitted {
            *transmitted_n += own_n.smooth;
        }
    }
}

impl<T: Real, E: Instrument<T>> EffectSet<T> for InInstrument<E> {
    type State = E::State;

    #[inline(always)]
    fn other(
        &self,
        _state: &Self::State,
        _journal: &JournalMotion<T>,
        _all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        *transmitted_n += self.0.constant_n();
    }

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.0.start(motion, rig)
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        <Self as Place<T>>::INFO.longest_step_s
    }
    #[inline]
    fn first(&self, s: &mut Self::State, force_n: T) -> T {
        self.0.first(s, force_n)
    }
    #[inline(always)]
    fn reading(&self, s: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        self.0.step(s, signal, time_s, dt_s)
    }
}
