//! Rate of the film and number of inner steps of a chain along motions.

use crate::motion::Motion;
use jbf_catalogue::Using;
use jbf_core::internals;
use jbf_core::law::Named;
use jbf_core::Chain;

/// Computes the fastest rate of the film along any of the motions, 1/s.
pub struct FilmRate<'a> {
    pub motions: &'a [&'a Motion],
}

impl Using<f64> for FilmRate<'_> {
    type Output = f64;

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> f64 {
        let rates = self
            .motions
            .iter()
            .map(|motion| internals::film_rate_1_s(&chain, &motion.record()));
        rates.fold(0.0, f64::max)
    }
}

/// Computes the number of inner steps along all motions.
pub struct InnerSteps<'a> {
    pub motions: &'a [&'a Motion],
    pub max_step_s: f64,
}

impl Using<f64> for InnerSteps<'_> {
    type Output = f64;

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> f64 {
        let along = |m: &&Motion| internals::inner_steps(&chain, &m.record(), self.max_step_s);
        self.motions.iter().map(along).sum()
    }
}
