//! Several journal laws and films in parallel, with one array per variable.
//!
//! The compiler can then place adjacent laws in the lanes of one vector register. The physics is in
//! [`Journal`]; this module only arranges the data. `T` is meant to be a lane
//! ([`Real::SIDE_BY_SIDE`]).

use super::{Journal, Loaded, State};
use crate::clock::Clock;
use crate::real::Real;
use nalgebra::Vector2;

/// Constants of `N` journal laws and states of their films, with one array per variable.
#[derive(Clone, Copy, Debug)]
pub struct SideBySide<T, const N: usize> {
    fb_per_n: [T; N],
    f_m: [T; N],
    k0: [T; N],
    viscous_s_m: [T; N],
    inverse_u_tr: [T; N],
    rate: [T; N],
    load_n: [T; N],
    load_number: [T; N],
    inverse_load_number: [T; N],
    eps_tr: [T; N],
    x: [T; N],
    y: [T; N],
    e2: [T; N],
    kept_x: [T; N],
    kept_y: [T; N],
    clamped: [u32; N],
}

/// Converts a value to another number type of the same precision, without derivatives.
#[inline(always)]
fn as_kind<S: Real, T: Real>(value: S) -> T {
    T::of(value.value())
}

impl<T: Real, const N: usize> SideBySide<T, N> {
    /// Creates the arrays from laws and films of a number type of the same precision.
    pub fn new<S: Real>(laws: &[Journal<S>; N], films: &[State<S>; N]) -> Self {
        let law = |pick: fn(&Journal<S>) -> S| core::array::from_fn(|i| as_kind(pick(&laws[i])));
        let film = |pick: fn(&State<S>) -> S| core::array::from_fn(|i| as_kind(pick(&films[i])));
        Self {
            fb_per_n: law(|l| l.fb_per_n),
            f_m: law(|l| l.f_m),
            k0: law(|l| l.k0),
            viscous_s_m: law(|l| l.viscous_s_m),
            inverse_u_tr: law(|l| l.inverse_u_tr),
            rate: law(|l| l.rate),
            load_n: film(|f| f.loaded.load_n),
            load_number: film(|f| f.loaded.load_number),
            inverse_load_number: film(|f| f.loaded.inverse_load_number),
            eps_tr: film(|f| f.loaded.eps_tr),
            x: film(|f| f.xy[0]),
            y: film(|f| f.xy[1]),
            e2: film(|f| f.e2),
            kept_x: film(|f| f.kept[0]),
            kept_y: film(|f| f.kept[1]),
            clamped: core::array::from_fn(|i| films[i].clamped),
        }
    }

    /// Returns law number `i`, for stepping only: its nominal load is that of the film, and its
    /// rate includes the time scale.
    #[inline(always)]
    pub fn law(&self, i: usize) -> Journal<T> {
        Journal {
            fb_per_n: self.fb_per_n[i],
            f_m: self.f_m[i],
            k0: self.k0[i],
            viscous_s_m: self.viscous_s_m[i],
            inverse_u_tr: self.inverse_u_tr[i],
            rate: self.rate[i],
            nominal: self.loaded(i),
            clock: Clock::Journal,
        }
    }

    #[inline(always)]
    fn loaded(&self, i: usize) -> Loaded<T> {
        Loaded {
            load_n: self.load_n[i],
            load_number: self.load_number[i],
            inverse_load_number: self.inverse_load_number[i],
            eps_tr: self.eps_tr[i],
        }
    }

    /// Returns the state of film number `i`.
    #[inline(always)]
    pub fn film(&self, i: usize) -> State<T> {
        State {
            xy: Vector2::new(self.x[i], self.y[i]),
            e2: self.e2[i],
            kept: Vector2::new(self.kept_x[i], self.kept_y[i]),
            loaded: self.loaded(i),
            clamped: self.clamped[i],
        }
    }

    /// Returns the state of film number `i` in a scalar number type.
    pub fn film_alone<S: Real>(&self, i: usize) -> State<S> {
        let film = self.film(i);
        State {
            xy: film.xy.map(as_kind),
            e2: as_kind(film.e2),
            kept: film.kept.map(as_kind),
            loaded: Loaded {
                load_n: as_kind(film.loaded.load_n),
                load_number: as_kind(film.loaded.load_number),
                inverse_load_number: as_kind(film.loaded.inverse_load_number),
                eps_tr: as_kind(film.loaded.eps_tr),
            },
            clamped: film.clamped,
        }
    }

    /// Replaces the state of film number `i`, under the load that the film had.
    #[inline(always)]
    pub fn put<S: Real>(&mut self, i: usize, film: &State<S>) {
        self.x[i] = as_kind(film.xy[0]);
        self.y[i] = as_kind(film.xy[1]);
        self.e2[i] = as_kind(film.e2);
        self.kept_x[i] = as_kind(film.kept[0]);
        self.kept_y[i] = as_kind(film.kept[1]);
        self.clamped[i] = film.clamped;
    }

    /// Returns the number of steps of each film that left the bearing.
    #[inline(always)]
    pub fn clamped(&self) -> [u32; N] {
        self.clamped
    }
}
