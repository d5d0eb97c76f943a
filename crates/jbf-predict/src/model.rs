//! Prediction model: a law and effects that are selected by name.

use crate::run::Run;
use jbf_batch::film_path::Place;
use jbf_batch::Baseline;
use jbf_catalogue::{Spec, Using};
use jbf_core::effect::Info;
use jbf_core::run::Record;
use jbf_core::{law, Bearing, Clock, Error, Real};

/// Prediction model: a friction law with effects.
///
/// The parameters are passed with each call: those of the law first, then those of each effect.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// Description of the law in the catalogue.
    pub law: &'a law::Info,
    /// Bearing of the law; `None` for a law in newtons.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N; `None` for a law in newtons.
    pub load_n: Option<f64>,
    /// Time scale of the film; ignored by a law without a film.
    pub clock: Clock,
    /// Descriptions of the effects in the catalogue; all must apply to the law.
    pub effects: &'a [&'a Info],
    /// Longest inner step between two samples, s.
    pub max_step_s: f64,
}

/// Precomputed states of a film along a record ([`jbf_batch::film_path`]).
#[derive(Clone, Copy, Debug)]
pub struct FilmPath<'a> {
    /// States of the film, one per step.
    pub places: &'a [Place],
    /// For each sample that a step leads to, the index of that step.
    pub ends: &'a [u32],
}

impl Model<'_> {
    /// Creates the chain with the given parameter values and passes it to the operation `then`.
    ///
    /// # Errors
    /// Reports the first parameter that violates its rule.
    ///
    /// # Panics
    /// If there are fewer values than parameters.
    pub fn with_chain<T: Real, U: Using<T>>(
        &self,
        parameters: &[T],
        then: U,
    ) -> Result<U::Output, Error> {
        let (values, mut rest) = parameters.split_at(self.law.parameters.len());
        let effects = self.effects.iter().map(|info| {
            let (own, after) = rest.split_at(info.parameters.len());
            rest = after;
            (info.name, own)
        });
        let spec = Spec {
            law: self.law.name,
            values,
            bearing: self.bearing,
            load_n: self.load_n,
            clock: self.clock,
        };
        spec.chain(effects, then)
    }

    /// Computes the friction readings along a record, N, one per sample, on a precomputed path of
    /// the film if there is one.
    ///
    /// # Errors
    /// Reports the first parameter that violates its rule.
    pub fn readings(
        &self,
        parameters: &[f64],
        record: &Record<'_>,
        path: Option<FilmPath<'_>>,
    ) -> Result<Vec<f64>, Error> {
        let mut readings = vec![0.0; record.time_s.len()];
        let run = Run {
            record,
            max_step_s: self.max_step_s,
            path: path.map(|path| (path, parameters)),
            // A scalar computation gains nothing from wider registers.
            instructions: Baseline,
            sink: &mut |i, reading| readings[i] = reading,
        };
        self.with_chain(parameters, run)?;
        Ok(readings)
    }
}
