//! Derivatives of the readings with respect to a group of parameters per pass over a record, in
//! vector registers.

use crate::model::{FilmPath, Model};
use crate::run::Run;
use jbf_batch::{Baseline, InstructionSet, Simd};
use jbf_core::run::Record;
use jbf_core::{Dual, Error, Real};

/// Number of parameters in the shortest pass, usually those of a law.
const FEW: usize = 4;
/// Number of parameters in the usual pass, which takes a quarter longer than the shortest.
const MANY: usize = 8;
/// Number of parameters in the longest pass, which takes three quarters of the time of two usual
/// ones.
const MOST: usize = 12;

/// Divides the indices of parameters, `which`, into groups for [`Model::derivatives`].
///
/// The derivatives with respect to one group are computed in one pass over a record. The largest
/// group depends on the instruction set of the machine.
pub fn parameter_passes(which: &[usize]) -> Vec<&[usize]> {
    match which.len() {
        0 => vec![&[]],
        9..=MOST if !only_passes_of_eight(Simd::best()) => vec![which],
        _ => which.chunks(MANY).collect(),
    }
}

/// Returns true on a processor without AVX2, for which only passes with eight parameters are
/// compiled.
fn only_passes_of_eight(simd: Simd) -> bool {
    cfg!(all(feature = "wide", target_arch = "x86_64")) && matches!(simd, Simd::Baseline)
}

impl Model<'_> {
    /// Computes the readings (N) along a record, and their derivatives with respect to the
    /// parameters `which`.
    ///
    /// The derivatives have one row per sample. `which` contains indices and is a group of
    /// [`parameter_passes`].
    ///
    /// # Errors
    /// Reports the first parameter that violates its rule.
    ///
    /// # Panics
    /// If `which` has more parameters than a pass.
    pub fn derivatives(
        &self,
        parameters: &[f64],
        which: &[usize],
        record: &Record<'_>,
        path: Option<FilmPath<'_>>,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        let pass = Pass {
            model: self,
            parameters,
            which,
            record,
            path,
        };
        match Simd::best() {
            // Registers wider than those of AVX2 gain nothing: a derivative of a chain is short
            // arithmetic between loads and stores.
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            // Uses its subset AVX2.
            Simd::Avx512(v4) => pass.of_any_width(*v4),
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Simd::Avx2(v3) => pass.of_any_width(v3),
            #[cfg(all(feature = "wide", target_arch = "x86_64"))]
            Simd::Baseline => pass.of::<MANY, _>(Baseline),
            #[cfg(not(all(feature = "wide", target_arch = "x86_64")))]
            Simd::Baseline => pass.of_any_width(Baseline),
        }
    }
}

/// Arguments of one pass over a record.
struct Pass<'a> {
    model: &'a Model<'a>,
    parameters: &'a [f64],
    which: &'a [usize],
    record: &'a Record<'a>,
    path: Option<FilmPath<'a>>,
}

impl Pass<'_> {
    fn of_any_width<I: InstructionSet>(
        &self,
        instructions: I,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        match self.which.len() {
            n if n <= FEW => self.of::<FEW, I>(instructions),
            n if n <= MANY => self.of::<MANY, I>(instructions),
            _ => self.of::<MOST, I>(instructions),
        }
    }

    fn of<const LANES: usize, I: InstructionSet>(
        &self,
        instructions: I,
    ) -> Result<(Vec<f64>, Vec<f64>), Error> {
        assert!(
            self.which.len() <= LANES,
            "too many parameters for one pass"
        );
        let lifted: Vec<Dual<LANES>> = self
            .parameters
            .iter()
            .enumerate()
            .map(|(i, &v)| match self.which.iter().position(|&w| w == i) {
                Some(lane) => Dual::parameter(v, lane),
                None => Dual::of(v),
            })
            .collect();
        let samples = self.record.time_s.len();
        let mut readings = vec![0.0; samples];
        let mut slopes = vec![[0.0; LANES]; samples];
        let run = Run {
            record: self.record,
            max_step_s: self.model.max_step_s,
            path: self.path.map(|path| (path, lifted.as_slice())),
            instructions,
            sink: &mut |i, reading: Dual<LANES>| {
                readings[i] = reading.value;
                slopes[i] = reading.slope;
            },
        };
        self.model.with_chain(&lifted, run)?;
        let rows = slopes.iter().flat_map(|row| &row[..self.which.len()]);
        Ok((readings, rows.copied().collect()))
    }
}
