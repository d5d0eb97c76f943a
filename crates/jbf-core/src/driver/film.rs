//! Interface between the driver and a film model: smooth equations between kinks.

use crate::law::journal::film_linear::SmoothFilm;
use crate::law::journal::Journal;
use crate::law::journal_full::motion::FullFilm;
use crate::law::journal_full::JournalFull;
use crate::real::Real;
use crate::stepper::StiffSystem;

/// Seals [`Film`]: the error control of the driver is written for these films.
mod sealed {
    pub trait Sealed {}
    impl<T> Sealed for crate::law::journal::Journal<T> {}
    impl<T> Sealed for crate::law::journal_full::JournalFull<T> {}
}

/// A film that the driver can integrate: [`Journal`] or [`JournalFull`].
///
/// Its first two states are `eps cos(phi)` and `eps sin(phi)`.
pub trait Film<T: Real, const N: usize>: sealed::Sealed {
    /// The equations with or without asperity contact, smooth everywhere.
    type System: StiffSystem<T, N> + Copy;

    /// Returns the equations with (`touching`) or without asperity contact.
    fn system(&self, touching: bool) -> Self::System;

    /// Returns the state at a position, without velocity.
    fn at(&self, xy: [T; 2]) -> [T; N];

    /// Film without inertia: load, friction and clock.
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
