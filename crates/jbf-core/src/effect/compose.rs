//! Sets of effects composed of other sets: a pair, and an optional set.

use super::{EffectSet, Resistance, Rig, Signal};
use crate::friction::Friction;
use crate::law::Scales;
use crate::motion::{JournalMotion, Motion};
use crate::real::Real;

/// Pair of sets; the effects of the first act first at every stage of the signal chain.
impl<T: Real, A: EffectSet<T>, B: EffectSet<T>> EffectSet<T> for (A, B) {
    type State = (A::State, B::State);

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        (self.0.start(motion, rig), self.1.start(motion, rig))
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        self.0.longest_step_s().min(self.1.longest_step_s())
    }
    #[inline]
    fn remembers(&self) -> bool {
        self.0.remembers() || self.1.remembers()
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.0.has_drive() || self.1.has_drive()
    }
    #[inline(always)]
    fn drive(&self, s: &mut Self::State, journal: &mut JournalMotion<T>, rig: &Rig<T>, dt_s: T) {
        self.0.drive(&mut s.0, journal, rig, dt_s);
        self.1.drive(&mut s.1, journal, rig, dt_s);
    }
    #[inline(always)]
    fn resist(&self, s: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        self.0.resist(&mut s.0, resistance, dt_s);
        self.1.resist(&mut s.1, resistance, dt_s);
    }
    #[inline]
    fn transmitted_n(&self, s: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        let first = self.0.transmitted_n(&s.0, motion, rig);
        first.or_else(|| self.1.transmitted_n(&s.1, motion, rig))
    }
    #[inline(always)]
    fn lubricant(&self, s: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        self.0.lubricant(&s.0, journal, factor);
        self.1.lubricant(&s.1, journal, factor);
    }
    #[inline(always)]
    fn warm(&self, s: &mut Self::State, power_w: T, dt_s: T) {
        self.0.warm(&mut s.0, power_w, dt_s);
        self.1.warm(&mut s.1, power_w, dt_s);
    }
    #[inline(always)]
    fn scales(
        &self,
        s: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        self.0.scales(&mut s.0, share, scales);
        self.1.scales(&mut s.1, share, scales);
    }
    #[inline(always)]
    fn film_rate(&self, s: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        self.0.film_rate(&s.0, journal, rate);
        self.1.film_rate(&s.1, journal, rate);
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.0.fastest_film() * self.1.fastest_film()
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
        self.0.contact(&mut s.0, from, to, sliding, dt_s);
        self.1.contact(&mut s.1, from, to, sliding, dt_s);
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
        let first = self.0.bristle(&mut s.0, from, to, magnitude, dt_s);
        first.or_else(|| self.1.bristle(&mut s.1, from, to, magnitude, dt_s))
    }
    #[inline(always)]
    fn other(
        &self,
        s: &Self::State,
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        self.0.other(&s.0, journal, all_n, transmitted_n);
        self.1.other(&s.1, journal, all_n, transmitted_n);
    }
    #[inline(always)]
    fn transmission(&self, s: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        self.0.transmission(&s.0, transmitted_n, sliding);
        self.1.transmission(&s.1, transmitted_n, sliding);
    }
    #[inline]
    fn first(&self, s: &mut Self::State, force_n: T) -> T {
        let reading_n = self.0.first(&mut s.0, force_n);
        self.1.first(&mut s.1, reading_n)
    }
    #[inline(always)]
    fn reading(&self, s: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        let signal = self.0.reading(&mut s.0, signal, time_s, dt_s);
        self.1.reading(&mut s.1, signal, time_s, dt_s)
    }
}

/// Optional set of effects; `None` has no effect.
impl<T: Real, A: EffectSet<T>> EffectSet<T> for Option<A> {
    type State = Option<A::State>;

    fn start(&self, motion: &Motion<T>, rig: &Rig<T>) -> Self::State {
        self.as_ref().map(|set| set.start(motion, rig))
    }
    #[inline]
    fn longest_step_s(&self) -> f64 {
        self.as_ref().map_or(f64::INFINITY, A::longest_step_s)
    }
    #[inline]
    fn remembers(&self) -> bool {
        self.as_ref().is_some_and(A::remembers)
    }
    #[inline(always)]
    fn has_drive(&self) -> bool {
        self.as_ref().is_some_and(A::has_drive)
    }
    #[inline(always)]
    fn drive(&self, s: &mut Self::State, journal: &mut JournalMotion<T>, rig: &Rig<T>, dt_s: T) {
        if let (Some(set), Some(s)) = (self, s) {
            set.drive(s, journal, rig, dt_s);
        }
    }
    #[inline(always)]
    fn resist(&self, s: &mut Self::State, resistance: &Resistance<T>, dt_s: T) {
        if let (Some(set), Some(s)) = (self, s) {
            set.resist(s, resistance, dt_s);
        }
    }
    #[inline]
    fn transmitted_n(&self, s: &Self::State, motion: &Motion<T>, rig: &Rig<T>) -> Option<T> {
        match (self, s) {
            (Some(set), Some(s)) => set.transmitted_n(s, motion, rig),
            _ => None,
        }
    }
    #[inline(always)]
    fn lubricant(&self, s: &Self::State, journal: &JournalMotion<T>, factor: &mut T) {
        if let (Some(set), Some(s)) = (self, s) {
            set.lubricant(s, journal, factor);
        }
    }
    #[inline(always)]
    fn warm(&self, s: &mut Self::State, power_w: T, dt_s: T) {
        if let (Some(set), Some(s)) = (self, s) {
            set.warm(s, power_w, dt_s);
        }
    }
    #[inline(always)]
    fn scales(
        &self,
        s: &mut Self::State,
        share: impl Fn() -> T + Copy,
        scales: &mut Option<Scales<T>>,
    ) {
        if let (Some(set), Some(s)) = (self, s) {
            set.scales(s, share, scales);
        }
    }
    #[inline(always)]
    fn film_rate(&self, s: &Self::State, journal: &JournalMotion<T>, rate: &mut T) {
        if let (Some(set), Some(s)) = (self, s) {
            set.film_rate(s, journal, rate);
        }
    }
    #[inline]
    fn fastest_film(&self) -> f64 {
        self.as_ref().map_or(1.0, A::fastest_film)
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
        if let (Some(set), Some(s)) = (self, s) {
            set.contact(s, from, to, sliding, dt_s);
        }
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
        match (self, s) {
            (Some(set), Some(s)) => set.bristle(s, from, to, magnitude, dt_s),
            _ => None,
        }
    }
    #[inline(always)]
    fn other(
        &self,
        s: &Self::State,
        journal: &JournalMotion<T>,
        all_n: &mut Friction<T>,
        transmitted_n: &mut T,
    ) {
        if let (Some(set), Some(s)) = (self, s) {
            set.other(s, journal, all_n, transmitted_n);
        }
    }
    #[inline(always)]
    fn transmission(&self, s: &Self::State, transmitted_n: T, sliding: &mut Friction<T>) {
        if let (Some(set), Some(s)) = (self, s) {
            set.transmission(s, transmitted_n, sliding);
        }
    }
    #[inline]
    fn first(&self, s: &mut Self::State, force_n: T) -> T {
        match (self, s) {
            (Some(set), Some(s)) => set.first(s, force_n),
            _ => force_n,
        }
    }
    #[inline(always)]
    fn reading(&self, s: &mut Self::State, signal: Signal<T>, time_s: T, dt_s: T) -> Signal<T> {
        match (self, s) {
            (Some(set), Some(s)) => set.reading(s, signal, time_s, dt_s),
            _ => signal,
        }
    }
}
