//! Construction of a signal chain from the names of its law and effects, and the values of their
//! parameters.
//!
//! Files, Python and fingerprints use this form. Values are in the order of the descriptions of the
//! parameters.

use jbf_core::effect::Effects;
use jbf_core::law::{with_law, Named, Visitor};
use jbf_core::{Bearing, Chain, Clock, Error, Real};

/// Name of a law with the arguments of its constructor.
#[derive(Clone, Copy, Debug)]
pub struct Spec<'a, T> {
    /// Name of the law.
    pub law: &'a str,
    /// Parameters of the law, in the order of its description.
    pub values: &'a [T],
    /// Bearing of the law; `None` for a law in newtons.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N; `None` for a law in newtons.
    pub load_n: Option<f64>,
    /// Time scale of the film; ignored by a law without a film.
    pub clock: Clock,
}

/// Operation on a chain whose law is selected by name at run time.
pub trait Using<T: Real> {
    /// Result of the operation.
    type Output;

    /// Performs the operation on a chain.
    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output;
}

struct Build<'a, T: Real, U> {
    effects: Effects<T>,
    bearing: Option<&'a Bearing>,
    then: U,
}

impl<T: Real, U: Using<T>> Visitor<T> for Build<'_, T, U> {
    type Output = U::Output;

    fn visit<L: Named<T>>(self, law: L) -> U::Output {
        let chain = Chain::new(law).with_effects(self.effects);
        self.then.with(match self.bearing {
            Some(bearing) => chain.on(bearing),
            None => chain,
        })
    }
}

impl<T: Real> Spec<'_, T> {
    /// Creates the law, adds the effects, and passes the chain to the operation `then`.
    ///
    /// # Errors
    /// Reports the first number that violates its rule, first for the effects and then for the law,
    /// or an unknown name of an effect or a law.
    pub fn chain<'e, V: AsRef<[T]>, U: Using<T>>(
        &self,
        effects: impl IntoIterator<Item = (&'e str, V)>,
        then: U,
    ) -> Result<U::Output, Error> {
        let mut all = Effects::NONE;
        for (name, values) in effects {
            all.set(name, values.as_ref())?;
        }
        let build = Build {
            effects: all,
            bearing: self.bearing,
            then,
        };
        let (bearing, load_n) = (self.bearing, self.load_n);
        with_law(self.law, bearing, load_n, self.values, self.clock, build)
    }
}
