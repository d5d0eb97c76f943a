//! An effect of one's own, from outside this crate: write a type with [`super::Effect`] and its stage's
//! trait, put it into that stage, and give it to [`super::Effects::with`]. It acts after those of
//! the catalogue in its stage; a pair acts from left to right.
//!
//! ```ignore
//! let effects = Effects::NONE.with(Beside(MyWiper::new(&[0.5])?));
//! ```
//!
//! `cargo run --example own_effect` shows the whole of it.

use super::{Contact, Instrument, OtherFriction, Rig, Signal};
use crate::friction::Friction;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;
use core::fmt::Debug;

/// What stands in a chain beside the catalogue; use [`InContact`], [`Beside`], [`InInstrument`],
/// or a pair of these.
pub trait Own<T: Real>: Copy + Debug {
    /// What it remembers.
    type State: Copy + Debug;

    /// The state at the start of a run.
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State;

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

    /// Other friction, N.
    #[inline(always)]
    fn other(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T> {
        let _ = (state, journal);
        Friction::NONE
    }

    /// Instrument: the first reading, N.
    #[inline(always)]
    fn first(&self, state: &mut Self::State, force_n: T) -> T {
        let _ = state;
        force_n
    }

    /// Instrument: the signal of a step.
    #[inline(always)]
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let _ = (state, time_s, dt_s);
        signal
    }
}

/// Nothing beside the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct Nothing;

impl<T: Real> Own<T> for Nothing {
    type State = ();
    #[inline(always)]
    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

/// An effect in the contact.
#[derive(Clone, Copy, Debug)]
pub struct InContact<E>(pub E);

/// Friction beside the bearing's.
#[derive(Clone, Copy, Debug)]
pub struct Beside<E>(pub E);

/// An effect of the instrument.
#[derive(Clone, Copy, Debug)]
pub struct InInstrument<E>(pub E);

impl<T: Real, E: Contact<T> + Debug> Own<T> for InContact<E>
where
    E::State: Debug,
{
    type State = E::State;
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> E::State {
        self.0.start(motion, rig)
    }
    #[inline(always)]
    fn contact(
        &self,
        state: &mut E::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        self.0.step(state, from, to, dt_s);
        self.0.apply(state, to, sliding);
    }
}

impl<T: Real, E: OtherFriction<T> + Debug> Own<T> for Beside<E>
where
    E::State: Debug,
{
    type State = E::State;
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> E::State {
        self.0.start(motion, rig)
    }
    #[inline(always)]
    fn other(&self, state: &E::State, journal: &JournalMotion<T>) -> Friction<T> {
        self.0.friction_n(state, journal)
    }
}

impl<T: Real, E: Instrument<T> + Debug> Own<T> for InInstrument<E>
where
    E::State: Debug,
{
    type State = E::State;
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> E::State {
        self.0.start(motion, rig)
    }
    #[inline(always)]
    fn first(&self, state: &mut E::State, force_n: T) -> T {
        self.0.first(state, force_n)
    }
    #[inline(always)]
    fn step(&self, state: &mut E::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        self.0.step(state, signal, time_s, dt_s)
    }
}

impl<T: Real, A: Own<T>, B: Own<T>> Own<T> for (A, B) {
    type State = (A::State, B::State);
    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        (self.0.start(motion, rig), self.1.start(motion, rig))
    }
    #[inline(always)]
    fn contact(
        &self,
        state: &mut Self::State,
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        self.0.contact(&mut state.0, from, to, sliding, dt_s);
        self.1.contact(&mut state.1, from, to, sliding, dt_s);
    }
    #[inline(always)]
    fn other(&self, state: &Self::State, journal: &JournalMotion<T>) -> Friction<T> {
        let (a, b) = (
            self.0.other(&state.0, journal),
            self.1.other(&state.1, journal),
        );
        Friction {
            jump: a.jump + b.jump,
            smooth: a.smooth + b.smooth,
        }
    }
    #[inline(always)]
    fn first(&self, state: &mut Self::State, force_n: T) -> T {
        let reading = self.0.first(&mut state.0, force_n);
        self.1.first(&mut state.1, reading)
    }
    #[inline(always)]
    fn step(&self, state: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let signal = self.0.step(&mut state.0, signal, time_s, dt_s);
        self.1.step(&mut state.1, signal, time_s, dt_s)
    }
}
