//! What is predicted: a law and effects by their names.

use crate::run::Run;
use jbf_batch::Baseline;
use jbf_core::effect::Info;
use jbf_core::film_path::Place;
use jbf_core::record::Record;
use jbf_core::spec::{Spec, Using};
use jbf_core::{law, Bearing, Clock, ParameterError, Real};

/// A friction law with effects. The parameters come with each call: the law's first, then those of each
/// effect.
#[derive(Clone, Copy, Debug)]
pub struct Model<'a> {
    /// The law's page in the catalogue.
    pub law: &'a law::Info,
    /// The bearing; a law in newtons needs none.
    pub bearing: Option<&'a Bearing>,
    /// Load on one bearing, N, for a law that needs it.
    pub load_n: Option<f64>,
    /// The clock of a law with a film.
    pub clock: Clock,
    /// The effects' pages in the catalogue, each of which goes with the law.
    pub effects: &'a [&'a Info],
    /// The longest inner step, s.
    pub max_step_s: f64,
}

/// The path of a film along a record, computed beforehand ([`jbf_core::film_path`]).
#[derive(Clone, Copy, Debug)]
pub struct FilmPath<'a> {
    /// The places of the film, one a step.
    pub places: &'a [Place],
    /// For each sample that a step leads to the number of that step.
    pub ends: &'a [u32],
}

impl Model<'_> {
    /// Build the chain with one set of parameter values and hand it to `then`.
    ///
    /// # Errors
    /// Names the first parameter that breaks its rule.
    ///
    /// # Panics
    /// Where there are fewer values than parameters.
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

    /// Friction readings along a record, N, one a sample.
    ///
    /// # Errors
    /// Names the first parameter that breaks its rule.
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
            // One number at a time gains nothing from wider registers.
            instructions: Baseline,
            sink: &mut |i, reading| readings[i] = reading,
        };
        self.with_chain(parameters, run)?;
        Ok(readings)
    }
}
