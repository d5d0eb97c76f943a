//! A chain from lists of values, as files, Python and fingerprints hand it over: the law and the
//! effects by their names, their numbers in the order of their pages.

use crate::bearing::Bearing;
use crate::chain::Chain;
use crate::clock::Clock;
use crate::effect::Effects;
use crate::error::ParameterError;
use crate::law::{with_law, Named, Visitor};
use crate::real::Real;

/// What a law is built from.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a, T> {
    /// The law's name.
    pub law: &'a str,
    /// Its parameters, in the order of its page.
    pub values: &'a [T],
    /// The bearing; a law in newtons needs none.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N, for a law that needs it.
    pub load_n: Option<f64>,
    /// The clock of a law with a film.
    pub clock: Clock,
}

/// Something to do with a chain of any law.
pub trait Using<T: Real> {
    /// What comes of it.
    type Output;

    /// Do it.
    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output;
}

struct Round<'a, T: Real, U> {
    effects: Effects<T>,
    bearing: Option<&'a Bearing>,
    then: U,
}

impl<T: Real, U: Using<T>> Visitor<T> for Round<'_, T, U> {
    type Output = U::Output;

    fn visit<L: Named<T>>(self, law: L) -> U::Output {
        self.then
            .with(Chain::round(law, self.effects, self.bearing))
    }
}

impl<T: Real> Spec<'_, T> {
    /// Build the law, put the effects round it, and hand the chain on.
    ///
    /// # Errors
    /// Names the first number that breaks its rule, an effect's before the law's, or says that
    /// there is no such effect or law.
    pub fn chain<'e, V: AsRef<[T]>, U: Using<T>>(
        &self,
        effects: impl IntoIterator<Item = (&'e str, V)>,
        then: U,
    ) -> Result<U::Output, ParameterError> {
        let mut all = Effects::NONE;
        for (name, values) in effects {
            all.set(name, values.as_ref())?;
        }
        let round = Round {
            effects: all,
            bearing: self.bearing,
            then,
        };
        let (bearing, load_n) = (self.bearing, self.load_n);
        with_law(self.law, bearing, load_n, self.values, self.clock, round)
    }
}
