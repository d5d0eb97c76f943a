//! Construction of a chain from names and lists of values.
//!
//! Files, Python and fingerprints use this form: names of the law and the effects, and their
//! parameters in the order of their descriptions.

use crate::bearing::Bearing;
use crate::chain::Chain;
use crate::clock::Clock;
use crate::effect::Effects;
use crate::error::ParameterError;
use crate::law::{with_law, Named, Visitor};
use crate::real::Real;

/// Arguments from which a law is built.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a, T> {
    /// Name of the law.
    pub law: &'a str,
    /// Parameters of the law, in the order of its description.
    pub values: &'a [T],
    /// Bearing; a law in newtons needs none.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N, for a law that needs it.
    pub load_n: Option<f64>,
    /// Clock of a law with a film.
    pub clock: Clock,
}

/// Operation on a chain of any law.
pub trait Using<T: Real> {
    /// Result of the operation.
    type Output;

    /// Performs the operation.
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
    /// Builds the law, adds the effects, and passes the chain to `then`.
    ///
    /// # Errors
    /// Names the first number that violates its rule, those of effects before those of the law, or
    /// reports that there is no such effect or law.
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
