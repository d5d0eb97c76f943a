//! What the driver needs of a law: smooth equations between kinks.

use crate::law::journal::film_linear::SmoothFilm;
use crate::law::journal::Journal;
use crate::law::journal_full::motion::FullFilm;
use crate::law::journal_full::JournalFull;
use crate::real::Real;
use crate::stepper::StiffSystem;

/// What seals [`Film`]: the driver's error control knows these films.
mod sealed {
    pub trait Sealed {}
    impl<T> Sealed for crate::law::journal::Journal<T> {}
    impl<T> Sealed for crate::law::journal_full::JournalFull<T> {}
}

/// A film that the driver can follow: [`Journal`] or [`JournalFull`]. Its first two states are `eps cos(phi)`, `eps sin(phi)`.
pub trait Film<T: Real, const N: usize>: sealed::Sealed {
    /// The equations with asperities in touch, or without them, smooth everywhere.
    type System: StiffSystem<T, N> + Copy;

    /// Those equations.
    fn system(&self, touching: bool) -> Self::System;

    /// The state at a place, without velocity.
    fn at(&self, xy: [T; 2]) -> [T; N];

    /// The film without inertia: load, friction, clock.
    fn journal(&self) -> &Journal<T>;
}

impl<T: Real> Film<T, 2> for Journal<T> {
    type System = SmoothFilm<T>;

    fn system(&self, touching: bool) -> SmoothFilm<T> {
        SmoothFilm::new(self, &self.nominal(), touching)
    }

    fn at(&self, xy: [T; 2]) -> [T; 2] {
        xy
    }

    fn journal(&self) -> &Journal<T> {
        self
    }
}

impl<T: Real> Film<T, 4> for JournalFull<T> {
    type System = FullFilm<T>;

    fn system(&self, touching: bool) -> FullFilm<T> {
        FullFilm::smooth(self, &self.film.nominal(), touching)
    }

    fn at(&self, [x, y]: [T; 2]) -> [T; 4] {
        [x, y, T::ZERO, T::ZERO]
    }

    fn journal(&self) -> &Journal<T> {
        &self.film
    }
}
