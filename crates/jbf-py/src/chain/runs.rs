//! One chain, of whatever law, along a motion: what its readings become.

use crate::film_paths::FilmPath;
use crate::motion::Motion;
use jbf_batch::Simd;
use jbf_core::effect::EffectSet;
use jbf_core::film_path::OnPath;
use jbf_core::law::{Law, Named};
use jbf_core::run::{self, Steps};
use jbf_core::spec::Using;
use jbf_core::{Chain, Dual, Real};

/// Runs a chain along a motion and gives every reading to a reader.
pub struct Run<'a, T, R> {
    pub reader: R,
    pub max_step_s: f64,
    pub motion: &'a Motion,
    /// The path of the film, and the law's parameters.
    pub path: Option<(&'a FilmPath, &'a [T])>,
}

/// What becomes of one run's readings.
pub trait Reader<T>: Sync {
    type Read: Send;
    fn simd() -> Simd {
        Simd::Baseline
    }
    fn read(&self, samples: usize, predict: impl FnOnce(&mut dyn FnMut(usize, T))) -> Self::Read;
}

/// Readings alone.
pub struct Values;

impl Reader<f64> for Values {
    type Read = Vec<f64>;
    fn read(&self, samples: usize, predict: impl FnOnce(&mut dyn FnMut(usize, f64))) -> Vec<f64> {
        let mut values = vec![0.0; samples];
        predict(&mut |i, f| values[i] = f);
        values
    }
}

/// Readings and their derivatives.
pub struct Slopes;

impl<const LANES: usize> Reader<Dual<LANES>> for Slopes {
    type Read = (Vec<f64>, Vec<[f64; LANES]>);
    fn simd() -> Simd {
        Simd::best()
    }
    fn read(
        &self,
        samples: usize,
        predict: impl FnOnce(&mut dyn FnMut(usize, Dual<LANES>)),
    ) -> Self::Read {
        let mut values = vec![0.0; samples];
        let mut slopes = vec![[0.0; LANES]; samples];
        predict(&mut |i, f| {
            values[i] = f.value;
            slopes[i] = f.slope;
        });
        (values, slopes)
    }
}

impl<T: Real, R: Reader<T>> Run<'_, T, R> {
    #[inline(always)]
    fn along<L: Law<T>>(&self, chain: &Chain<T, L>, made: Steps) -> R::Read {
        self.reader.read(self.motion.len(), |sink| {
            R::simd().dispatch(
                #[inline(always)]
                || run::predict_by(chain, &self.motion.record(), self.max_step_s, made, sink),
            );
        })
    }
}

impl<T: Real, R: Reader<T>> Using<T> for Run<'_, T, R> {
    type Output = R::Read;

    fn with<L: Named<T>>(self, chain: Chain<T, L>) -> Self::Output {
        let (Some((path, p)), Some([first, second])) = (self.path, L::FILM_PARAMETERS) else {
            return self.along(&chain, Steps::Every);
        };
        let law = OnPath::new(chain.law, [p[first], p[second]], &path.places);
        let (law, made) = if chain.effects.remembers() {
            (law, Steps::Every)
        } else {
            (law.at(&path.ends), Steps::Last)
        };
        let on_path = Chain {
            law,
            effects: chain.effects,
            rig: chain.rig,
        };
        self.along(&on_path, made)
    }
}

/// The fastest rate of the film along any of the motions, 1/s.
pub struct FilmRate<'a> {
    pub motions: &'a [&'a Motion],
}

impl Using<f64> for FilmRate<'_> {
    type Output = f64;

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> f64 {
        let rates = self
            .motions
            .iter()
            .map(|motion| run::film_rate_1_s(&chain, &motion.record()));
        rates.fold(0.0, f64::max)
    }
}

/// Inner steps along all of the motions.
pub struct InnerSteps<'a> {
    pub motions: &'a [&'a Motion],
    pub max_step_s: f64,
}

impl Using<f64> for InnerSteps<'_> {
    type Output = f64;

    fn with<L: Named<f64>>(self, chain: Chain<f64, L>) -> f64 {
        let along = |m: &&Motion| run::inner_steps(&chain, &m.record(), self.max_step_s);
        self.motions.iter().map(along).sum()
    }
}
