//! Batch of journal laws with a common integration method.
//!
//! The states of the films are in [`Films`], and the motion is passed with each call.

use crate::lane::Float;
use crate::part::{self, Block, Out, LANES};
use crate::simd::Simd;
use crate::speeds::Speeds;
use jbf_core::law::journal::{Journal, State};
use jbf_core::law::Law;
use rayon::prelude::*;

/// Integration method of the film equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Explicit Euler method, as in the control loop of Cohn (1998).
    #[default]
    Euler,
    /// Classical Runge-Kutta method of order four.
    Rk4,
}

/// Journal laws (parameter sets) that are stepped together.
#[derive(Clone, Debug)]
pub struct Batch<F> {
    laws: Vec<Journal<F>>,
    /// Integration method of the film equations.
    pub method: Method,
    /// Instruction set of the computation; [`Batch::new`] selects the best one of the machine.
    pub simd: Simd,
}

/// States of the films of a batch, one per law.
#[derive(Clone, Debug)]
pub struct Films<F>(pub Vec<State<F>>);

impl<F: Float> Batch<F> {
    /// Creates a batch of laws that are stepped together by `method`.
    pub fn new(laws: Vec<Journal<F>>, method: Method) -> Self {
        Self {
            laws,
            method,
            simd: Simd::best(),
        }
    }

    /// Returns the states of the films at the start of a run, each under the load given to its
    /// law's constructor.
    pub fn start(&self) -> Films<F> {
        let film = |law: &Journal<F>| law.start(law.nominal().load_n);
        Films(self.laws.iter().map(film).collect())
    }

    /// Computes the friction coefficients of all laws at every sample.
    ///
    /// `out` has one row per sample and one column per law. `films` contains the states before the
    /// call and is updated.
    ///
    /// # Panics
    /// If the sizes of `out`, `films` and `speeds` do not match.
    pub fn friction(&self, films: &mut Films<F>, speeds: &Speeds<'_, F>, dt_s: F, out: &mut [F]) {
        let sets = self.laws.len();
        assert_eq!(out.len(), speeds.len() * sets, "out: samples x sets");
        if out.is_empty() {
            return;
        }
        let parts = self.parts();
        let mut columns: Vec<Vec<&mut [F]>> = Vec::new();
        columns.resize_with(parts.len(), || Vec::with_capacity(speeds.len()));
        for mut row in out.chunks_exact_mut(sets) {
            for (column, &(first, end)) in columns.iter_mut().zip(&parts) {
                let (own, rest) = row.split_at_mut(end - first);
                column.push(own);
                row = rest;
            }
        }
        let outs = columns.into_iter().map(Out::Rows).collect();
        self.run(films, speeds, dt_s, &parts, outs);
    }

    /// Returns the sum over the samples of `(friction coefficient - data)^2` for each law.
    ///
    /// The friction coefficients are not stored.
    ///
    /// # Panics
    /// If the sizes of `data`, `films` and `speeds` do not match.
    pub fn squares(
        &self,
        films: &mut Films<F>,
        speeds: &Speeds<'_, F>,
        dt_s: F,
        data: &[F],
    ) -> Vec<F> {
        assert_eq!(data.len(), speeds.len(), "data: one value per sample");
        let parts = self.parts();
        let outs = parts.iter().map(|_| Out::Squares(data)).collect();
        self.run(films, speeds, dt_s, &parts, outs)
    }

    /// Divides the laws into parts for the threads.
    ///
    /// A part is a half-open range of indices that consists of whole blocks. There are two parts
    /// per thread, if there are enough blocks.
    fn parts(&self) -> Vec<(usize, usize)> {
        let sets = self.laws.len();
        let blocks = sets.div_ceil(LANES);
        let parts = (2 * rayon::current_num_threads()).clamp(1, blocks.max(1));
        let at = |i: usize| (blocks * i / parts * LANES).min(sets);
        (0..parts).map(|i| (at(i), at(i + 1))).collect()
    }

    fn run(
        &self,
        films: &mut Films<F>,
        speeds: &Speeds<'_, F>,
        dt_s: F,
        parts: &[(usize, usize)],
        outs: Vec<Out<'_, F>>,
    ) -> Vec<F> {
        assert_eq!(films.0.len(), self.laws.len(), "films: one per set");
        if let Speeds::Each { sets, .. } = speeds {
            assert_eq!(*sets, self.laws.len(), "speeds: one column per set");
        }
        let done: Vec<Vec<Block<F>>> = parts
            .par_iter()
            .zip(outs)
            .with_max_len(1)
            .map(|(&(first, end), mut out)| {
                let mut blocks = self.blocks(films, first, end);
                let (dt_s, method) = (dt_s, self.method);
                self.simd.dispatch(
                    #[inline(always)]
                    || part::run(&mut blocks, speeds, first, dt_s, method, &mut out),
                );
                blocks
            })
            .collect();
        let mut sums = Vec::with_capacity(self.laws.len() + LANES);
        for (blocks, &(first, end)) in done.iter().zip(parts) {
            for (i, film) in films.0[first..end].iter_mut().enumerate() {
                *film = blocks[i / LANES].film(i % LANES);
            }
            sums.extend(blocks.iter().flat_map(Block::sums).take(end - first));
        }
        sums
    }

    /// Groups the laws `first..end` and their films into blocks; the last block is filled up with
    /// copies of the last law.
    fn blocks(&self, films: &Films<F>, first: usize, end: usize) -> Vec<Block<F>> {
        (first..end)
            .step_by(LANES)
            .map(|at| {
                let set = |i: usize| (at + i).min(end - 1);
                let films = core::array::from_fn(|i| films.0[set(i)]);
                Block::new(core::array::from_fn(|i| self.laws[set(i)]), &films)
            })
            .collect()
    }
}
