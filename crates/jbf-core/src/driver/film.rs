//! Interface between the integration of trajectories and a film model: equations that are smooth
//! between kinks.

use crate::law::journal::film_linear::SmoothFilm;
use crate::law::journal::Journal;
use crate::law::journal_full::motion::FullFilm;
use crate::law::journal_full::JournalFull;
use crate::real::sealed::Sealed;
use crate::real::Real;
use crate::stepper::StiffSystem;
use nalgebra::{SVector, Vector2, Vector4};

// The error control is designed for the films of this crate.
impl<T> Sealed for Journal<T> {}
impl<T> Sealed for JournalFull<T> {}

/// Film model that the driver can integrate: [`Journal`] or [`JournalFull`].
///
/// Its first two states are `eps cos(phi)` and `eps sin(phi)`.
pub trait Film<T: Real, const N: usize>: Sealed {
    /// Film equations, either with or without asperity contact, smooth everywhere.
    type System: StiffSystem<T, N> + Copy;

    /// Returns the film equations with (`touching`) or without asperity contact.
    fn system(&self, touching: bool) -> Self::System;

    /// Returns the state at the position `(eps cos(phi), eps sin(phi))`, without velocity.
    fn at(&self, xy: Vector2<T>) -> SVector<T, N>;

    /// Returns the film without inertia, which has the same load, friction and time scale.
    fn journal(&self) -> &Journal<T>;
}

impl<T: Real> Film<T, 2> for Journal<T> {
    type System = SmoothFilm<T>;

    fn system(&self, touching: bool) -> SmoothFilm<T> {
        SmoothFilm::new(self, &self.nominal(), touching)
    }

    fn at(&self, xy: Vector2<T>) -> Vector2<T> {
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

    fn at(&self, xy: Vector2<T>) -> Vector4<T> {
        Vector4::new(xy.x, xy.y, T::ZERO, T::ZERO)
    }

    fn journal(&self) -> &Journal<T> {
        &self.film
    }
}
