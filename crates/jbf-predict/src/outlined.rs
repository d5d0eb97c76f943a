//! Effects of the catalogue, with each stage compiled as a separate function.
//!
//! In a chain with [`Effects`], the code of all effects is inlined into the time loop of the law.
//! With ten laws, four number types and two instruction sets, there would be about fifty copies of
//! this code. In this module, the code is compiled once per number type and instruction set. A step
//! makes one call per stage with an effect, and none for a stage without effects.
//!
//! Arguments passed by reference must be in memory. The states of the effects are therefore outside
//! the state of the chain, and a stage copies values in and out, so that the variables of the time
//! loop stay in registers.

use core::cell::RefCell;
use jbf_batch::InstructionSet;
use jbf_core::effect::{EffectSet, Effects, OccupiedStages, Resistance, Rig, Signal, States};
use jbf_core::friction::Friction;
use jbf_core::law::Scales;
use jbf_core::motion::{JournalMotion, Motion};
use jbf_core::Real;

/// Effects of the catalogue whose stages are functions that are compiled for the instruction set
/// `I`.
///
/// One value serves one run of one chain at a time, because copies share one cell of states. The
/// results are identical bit for bit to those of [`Effects`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outlined<'a, T: Real, I> {
    effects: &'a Effects<T>,
    states: &'a RefCell<States<T>>,
    occupied: OccupiedStages,
    instructions: I,
}

impl<'a, T: Real, I> Outlined<'a, T, I> {
    /// Creates the set from effects, the cell for their states, and an instruction set.
    pub(crate) fn new(
        effects: &'a Effects<T>,
        states: &'a RefCell<States<T>>,
        instructions: I,
    ) -> Self {
        Self {
            occupied: effects.occupied_stages(),
            effects,
            states,
            instructions,
        }
    }
}

impl<T: Real, I: InstructionSet> Outlined<'_, T, I> {
    /// Calls a stage as a separate function, into which the code of its effects is inlined.
    #[inline(always)]
    fn call<R>(&self, stage: impl FnOnce(&Effects<T>, &mut States<T>) -> R) -> R {
        let (effects, states) = (self.effects, self.states);
        self.instructions.call(
            #[inline(always)]
            move || stage(effects, &mut states.borrow_mut()),
        )
    }
}

impl<T: Real, I: InstructionSet> EffectSet<T> for Outlined<'_, T, I> {
    type State = ();

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) {
        *self.states.borrow_mut() = self.effects.start(motion, rig);
    }
    fn longest_step_s(&self) -> f64 {
        self.effects.longest_step_s()
    }
    fn remembers(&self) -> bool {
        self.effects.remembers()
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.occupied.drive
    }
    #[inline(always)]
    fn drive(&self, _: &mut (), journal: &mut JournalMotion<T>, rig: &Rig<T>, dt_s: T) {
        if self.occupied.drive {
            let (from, rig) = (*journal, *rig);
            *journal = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut to = from;
                    effects.drive(states, &mut to, &rig, dt_s);
                    to
                },
            );
        }
    }
    #[inline(always)]
    fn resist(&self, _: &mut (), resistance: &Resistance<T>, dt_s: T) {
        if self.occupied.drive {
            let resistance = *resistance;
            self.call(
                #[inline(always)]
                |effects, states| effects.resist(states, &resistance, dt_s),
            );
        }
    }
    fn transmitted_n(&self, _: &(), motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        self.effects
            .transmitted_n(&self.states.borrow(), motion, rig)
    }
    #[inline(always)]
    fn lubricant(&self, _: &(), journal: &JournalMotion<T>, factor: &mut T) {
        if self.occupied.lubricant {
            let (journal, before) = (*journal, *factor);
            *factor = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut factor = before;
                    effects.lubricant(states, &journal, &mut factor);
                    factor
                },
            );
        }
    }
    #[inline(always)]
    fn warm(&self, _: &mut (), power_w: T, dt_s: T) {
        if self.occupied.lubricant {
            self.call(
                #[inline(always)]
                |effects, states| effects.warm(states, power_w, dt_s),
            );
        }
    }
    #[inline(always)]
    fn scales(&self, _: &mut (), share: impl Fn() -> T + Copy, scales: &mut Option<Scales<T>>) {
        if self.occupied.load {
            let (share, before) = (share(), *scales);
            *scales = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut scales = before;
                    effects.scales(states, || share, &mut scales);
                    scales
                },
            );
        }
    }
    #[inline(always)]
    fn film_rate(&self, _: &(), journal: &JournalMotion<T>, rate: &mut T) {
        if self.occupied.lubricant || self.occupied.film {
            let (journal, before) = (*journal, *rate);
            *rate = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut rate = before;
                    effects.film_rate(states, &journal, &mut rate);
                    rate
                },
            );
        }
    }
    fn fastest_film(&self) -> f64 {
        self.effects.fastest_film()
    }
    #[inline(always)]
    fn contact(
        &self,
        _: &mut (),
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        sliding: &mut Friction<T>,
        dt_s: T,
    ) {
        if self.occupied.contact {
            let (from, to, before) = (*from, *to, *sliding);
            *sliding = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut sliding = before;
                    effects.contact(states, &from, &to, &mut sliding, dt_s);
                    sliding
                },
            );
        }
    }
    #[inline(always)]
    fn transmission(&self, _: &(), transmitted_n: T, sliding: &mut Friction<T>) {
        if self.occupied.transmission {
            let before = *sliding;
            *sliding = self.call(
                #[inline(always)]
                |effects, states| {
                    let mut sliding = before;
                    effects.transmission(states, transmitted_n, &mut sliding);
                    sliding
                },
            );
        }
    }
    #[inline(always)]
    fn bristle(
        &self,
        _: &mut (),
        from: &JournalMotion<T>,
        to: &JournalMotion<T>,
        magnitude: [T; 2],
        dt_s: T,
    ) -> Option<T> {
        if !self.occupied.bristle {
            return None;
        }
        let (from, to) = (*from, *to);
        self.call(
            #[inline(always)]
            |effects, states| effects.bristle(states, &from, &to, magnitude, dt_s),
        )
    }
    #[inline(always)]
    fn other(
        &self,
        _: &(),
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        let constant = self.occupied.instrument && self.occupied.transmission;
        if self.occupied.other || constant {
            let (journal, before) = (*journal, (*all_n, *transmitted_n));
            (*all_n, *transmitted_n) = self.call(
                #[inline(always)]
                |effects, states| {
                    let (mut all_n, mut transmitted_n) = before;
                    effects.other(states, &journal, &mut all_n, &mut transmitted_n);
                    (all_n, transmitted_n)
                },
            );
        }
    }
    fn first(&self, _: &mut (), force_n: T) -> T {
        self.effects.first(&mut self.states.borrow_mut(), force_n)
    }
    #[inline(always)]
    fn reading(&self, _: &mut (), signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        if !self.occupied.instrument {
            return signal;
        }
        self.call(
            #[inline(always)]
            |effects, states| effects.reading(states, signal, time_s, dt_s),
        )
    }
}
