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

/// Passes the list of the methods of [`Effect`] to the macro `$set`, which defines them for a set.
///
/// The first lines have a property of a set: its type, its value for a set without effects, and the
/// function that combines the values of two members. Each further line has a method of a stage, the
/// stages of the catalogue that it concerns, the kind of reference to the state, and the arguments:
/// inputs by reference, quantities that the members change in turn, and values. A set of fields
/// passes their names in brackets, which precede the lines.
#[doc(hidden)]
#[macro_export]
macro_rules! forward_stages {
    ($set:ident $($fields:tt)?) => {
        $set! {
            $($fields)?
            (longest_step_s f64 = f64::INFINITY, f64::min)
            (has_memory bool = false, core::ops::BitOr::bitor)
            (has_drive bool = false, core::ops::BitOr::bitor)
            (fastest_film f64 = 1.0, core::ops::Mul::mul)
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
    ($(($p:ident $P:ty = $none:expr, $join:path))* $($m:ident $stages:tt [$($ref:tt)+]
        ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*) ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $p(&self) -> $P {
            $join(self.0.$p(), self.1.$p())
        }
    )*$(
        #[inline(always)]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            self.0.$m($($ref)+ s.0, $($i,)* $($o,)* $($v),*);
            self.1.$m($($ref)+ s.1, $($i,)* $($o,)* $($v),*);
        }
    )*};
}

/// Methods of an optional set.
macro_rules! option {
    ($(($p:ident $P:ty = $none:expr, $join:path))* $($m:ident $stages:tt [$($ref:tt)+]
        ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*) ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $p(&self) -> $P {
            self.as_ref().map_or($none, A::$p)
        }
    )*$(
        #[inline(always)]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            if let (Some(set), Some(s)) = (self, s) {
                set.$m(s, $($i,)* $($o,)* $($v),*);
            }
        }
    )*};
}

/// Methods of the catalogue: properties of all stages, and methods of the stages that they concern.
///
/// With debug assertions each is a separate function, which reduces the compile time of tests to a
/// fraction.
macro_rules! stages {
    ($fields:tt $(($p:ident $P:ty = $none:expr, $join:path))* $($m:ident [$($stage:ident)+]
        [$($ref:tt)+] ($($i:ident: $I:ty),*) ($($o:ident: $O:ty),*) ($($v:ident: $V:ty),*);)*) => {$(
        #[inline(always)]
        fn $p(&self) -> $P {
            stages! { @ fold self $p $none, $join, $fields }
        }
    )*$(
        #[cfg_attr(debug_assertions, inline(never))]
        #[cfg_attr(not(debug_assertions), inline(always))]
        fn $m(&self, s: $($ref)+ Self::State, $($i: &$I,)* $($o: &mut $O,)* $($v: $V),*) {
            stages! { @ self s $m [$($ref)+] ($($i,)* $($o,)* $($v),*) $($stage)+ }
        }
    )*};
    (@ fold $self:ident $p:ident $none:expr, $join:path, [$($field:ident)+]) => {{
        let all = $none;
        $(let all = $join(all, $self.$field.$p());)+
        all
    }};
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
    const HAS_MEMORY: bool = A::HAS_MEMORY || B::HAS_MEMORY;
    type State = (A::State, B::State);

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        (self.0.start(motion, rig), self.1.start(motion, rig))
    }
    forward_stages!(pair);
}

/// Optional set of effects; `None` has no effect.
impl<T: Real, A: Effect<T>> Effect<T> for Option<A> {
    const LONGEST_STEP_S: f64 = A::LONGEST_STEP_S;
    const HAS_MEMORY: bool = A::HAS_MEMORY;
    type State = Option<A::State>;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.as_ref().map(|set| set.start(motion, rig))
    }
    forward_stages!(option);
}
