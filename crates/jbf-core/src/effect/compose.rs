//! Sets of effects: the empty set, a pair, and an optional set.
//!
//! A set forwards each method of [`Effect`] to its members. The list in `forward_stages!` is the only
//! place in which the methods of the stages are enumerated for this purpose. `start` and the four
//! queries (`longest_step_s`, `has_memory`, `has_drive`, `fastest_film`) are written out for each
//! set.

use super::{Effect, Resistance, Rig, Signal};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Passes the list of the methods of the stages to the macro `$set`, which defines them for a set.
///
/// Each line has the method, the stages of the catalogue that it concerns, the kind of reference to
/// the state, and the arguments: inputs by reference, quantities that the members change in turn,
/// and values.
#[doc(hidden)]
#[macro_export]
macro_rules! forward_stages {
    ($($set:ident)::+) => {
        $($set)::+! {
            drive [drive] [&mut] (rig: Rig<T>) (journal: JournalMotion<T>) (dt_s: T);
            resist [drive] [&mut] (resistance: Resistance<T>) () (dt_s: T);
            transmitted_n [drive] [&] (motion: Motion<T>, rig: Rig<T>) (force_n: Option<T>) ();
            lubricant [lubricant] [&] (journal: JournalMotion<T>) (factor: T) ();
            heat [lubricant] [&mut] () () (power_w: T, dt_s: T);
            scales [load] [&mut] () (scales: Option<Scales<T>>) (share: T);
            film_rate [lubricant film] [&] (journal: JournalMotion<T>) (rate: T) ();
            contact [contact] [&mut] (from: JournalMotion<T>, to: JournalMotion<T>)
                (sliding: Friction<T>) (dt_s: T);
            transmission [transmission] [&] () (sliding: Friction<T>) (transmitted_n: T);
            bristle [bristle] [&mut] (from: JournalMotion<T>, to: JournalMotion<T>)
                (deflected: Option<T>) (magnitude: [T; 2], dt_s: T);
            add_friction [other instrument] [&] (journal: JournalMotion<T>)
                (sum_n: Friction<T>, transmitted_n: T) ();
            first_reading [instrument] [&mut] () (force_n: T) ();
            reading [instrument] [&mut] () (signal: Signal<T>) (time_s: T, dt_s: T);
        }
    };
}

/// Methods of a pair: those of the first member, then those of the second.
///
/// In this macro and in those below, `$m` is the method, `$ref` the kind of reference to the state,
/// `$i` an input, `$o` a quantity that the members change in turn, and `$v` a value.
macro_rules! pair {
    ($($m:ident $stages:tt [$($ref:tt)+] ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*)
        ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            self.0.$m($($ref)+ s.0, $($i,)* $($o,)* $($v),*);
            self.1.$m($($ref)+ s.1, $($i,)* $($o,)* $($v),*);
        }
    )*};
}

/// Methods of an optional set.
macro_rules! option {
    ($($m:ident $stages:tt [$($ref:tt)+] ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*)
        ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            if let (Some(set), Some(s)) = (self, s) {
                set.$m(s, $($i,)* $($o,)* $($v),*);
            }
        }
    )*};
}

/// Methods of the catalogue, each of which calls the stages that it concerns.
///
/// With debug assertions each is a separate function, which reduces the compile time of tests to a
/// fraction.
macro_rules! stages {
    ($($m:ident [$($stage:ident)+] [$($ref:tt)+] ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*)
        ($($v:ident: $V:ty),*);)*) => {$(
        #[cfg_attr(debug_assertions, inline(never))]
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            stages! { @ self s $m [$($ref)+] ($($i,)* $($o,)* $($v),*) $($stage)+ }
        }
    )*};
    (@ $self:ident $s:ident $m:ident [$($ref:tt)+] ($($a:ident),* $(,)?) $stage:ident $($more:ident)*) => {
        $self.$stage.$m($($ref)+ $s.$stage, $($a),*);
        stages! { @ $self $s $m [$($ref)+] ($($a),*) $($more)* }
    };
    (@ $self:ident $s:ident $m:ident $ref:tt $a:tt) => {};
}

pub(crate) use {forward_stages, stages};

/// Set without effects: the law alone.
impl<T: Real> Effect<T> for () {
    const LONGEST_STEP_S: f64 = f64::INFINITY;
    type State = ();

    #[inline(always)]
    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) {}
}

/// Pair of sets; the effects of the first act first at every stage of the signal chain.
impl<T: Real, A: Effect<T>, B: Effect<T>> Effect<T> for (A, B) {
    const LONGEST_STEP_S: f64 = A::LONGEST_STEP_S.min(B::LONGEST_STEP_S);
    type State = (A::State, B::State);

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        (self.0.start(motion, rig), self.1.start(motion, rig))
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        self.0.longest_step_s().min(self.1.longest_step_s())
    }
    #[inline]
    fn has_memory(&self) -> bool {
        self.0.has_memory() || self.1.has_memory()
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.0.has_drive() || self.1.has_drive()
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.0.fastest_film() * self.1.fastest_film()
    }
    forward_stages!(pair);
}

/// Optional set of effects; `None` has no effect.
impl<T: Real, A: Effect<T>> Effect<T> for Option<A> {
    const LONGEST_STEP_S: f64 = A::LONGEST_STEP_S;
    type State = Option<A::State>;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.as_ref().map(|set| set.start(motion, rig))
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        self.as_ref().map_or(f64::INFINITY, A::longest_step_s)
    }
    #[inline]
    fn has_memory(&self) -> bool {
        self.as_ref().is_some_and(A::has_memory)
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.as_ref().is_some_and(A::has_drive)
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.as_ref().map_or(1.0, A::fastest_film)
    }
    forward_stages!(option);
}
