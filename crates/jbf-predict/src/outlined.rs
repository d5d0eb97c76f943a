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
use jbf_core::effect::{Effect, Effects, Resistance, Rig, Signal, States};
use jbf_core::internals::OccupiedStages;
use jbf_core::law::Scales;
use jbf_core::{Friction, JournalMotion, Motion, Real};

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

/// Condition under which a method of a stage has an effect.
macro_rules! occupied {
    // An instrument adds a constant to the force that the transmission carries, and nothing else.
    ($occupied:expr, add_friction, $($stage:ident)+) => {
        $occupied.other || ($occupied.instrument && $occupied.transmission)
    };
    ($occupied:expr, $method:ident, $($stage:ident)+) => { $($occupied.$stage)||+ };
}

/// Properties of the effects, and methods that call a stage with copies of their arguments.
macro_rules! outlined {
    ($(($p:ident $P:ty = $none:expr, $join:path))* $($m:ident [$($stage:ident)+] [$($ref:tt)+]
        ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*) ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $p(&self) -> $P {
            self.effects.$p()
        }
    )*$(
        // Some methods change none of their arguments.
        #[allow(clippy::unused_unit)]
        #[inline(always)]
        fn $m(&self, _: $($ref)+ (), $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            if occupied!(self.occupied, $m, $($stage)+) {
                $(let $i = *$i;)*
                let before = ($(*$o,)*);
                ($(*$o,)*) = self.call(#[inline(always)] |effects, states| {
                    let ($(mut $o,)*) = before;
                    effects.$m(states, $(&$i,)* $(&mut $o,)* $($v),*);
                    ($($o,)*)
                });
            }
        }
    )*};
}

impl<T: Real, I: InstructionSet> Effect<T> for Outlined<'_, T, I> {
    type State = ();

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) {
        *self.states.borrow_mut() = self.effects.start(motion, rig);
    }
    jbf_core::forward_stages!(outlined);
}
