//! Prediction model: a law and effects, selected by name.

use crate::run::Run;
use jbf_batch::Baseline;
use jbf_core::effect::Info;
use jbf_core::film_path::Place;
use jbf_core::record::Record;
use jbf_core::spec::{Spec, Using};
use jbf_core::{law, Bearing, Clock, ParameterError, Real};

/// A friction law with effects.
///
/// The parameters are passed with each call: those of the law first, then those of each effect.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// Description of the law in the catalogue.
    pub law: &'a law::Info,
    /// Bearing; a law in newtons needs none.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N, for a law that needs it.
    pub load_n: Option<f64>,
    /// Clock of a law with a film.
    pub clock: Clock,
    /// Descriptions of the effects in the catalogue, all of which apply to the law.
    pub effects: &'a [&'a Info],
    /// Longest inner step, s.
    pub max_step_s: f64,
}

/// Precomputed path of a film along a record ([`jbf_core::film_path`]).
#[derive(Clone, Copy, Debug)]
pub struct FilmPath<'a> {
    /// States of the film, one per step.
    pub places: &'a [Place],
    /// Index of the step that leads to each sample, for samples with a step.
    pub ends: &'a [u32],
}

impl Model<'_> {
    /// Builds the chain with one set of parameter values and passes it to `then`.
    ///
    /// # Errors
    /// Names the first parameter that violates its rule.
    ///
    /// # Panics
    /// If there are fewer values than parameters.
    pub fn with_chain<T: Real, U: Using<T>>(
        &self,
        parameters: &[T],
        then: U,
    ) -> Result<U::Output, ParameterError> {
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

    /// Computes the friction readings along a record, N, one per sample.
    ///
    /// # Errors
    /// Names the first parameter that violates its rule.
    pub fn readings(
        &self,
        parameters: &[f64],
        record: &Record<'_>,
        path: Option<FilmPath<'_>>,
    ) -> Result<Vec<f64>, ParameterError> {
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
