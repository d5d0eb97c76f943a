//! Surface speed along a run: one motion for all parameter sets, or one per set.

use crate::lane::Float;
use crate::part::LANES;

/// Surface speed of the parameter sets of a batch at equally spaced samples, m/s.
#[derive(Clone, Copy, Debug)]
pub enum Speeds<'a, F> {
    /// The same motion for every parameter set: one speed per sample.
    Common(&'a [F]),
    /// A separate motion for each parameter set.
    Each {
        /// Speeds in row-major order, m/s: one row per sample, one column per parameter set.
        rows: &'a [F],
        /// Number of parameter sets (columns).
        sets: usize,
    },
}

impl<F: Float> Speeds<'_, F> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Common(speeds) => speeds.len(),
            Self::Each { rows, sets } => rows.len() / (*sets).max(1),
        }
    }

    /// True if there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Speeds of one block of a batch, for the inner loop; a common speed is read once for all lanes.
pub(crate) trait Course<F> {
    /// Returns the speed of each lane at a sample, m/s.
    fn at(&self, sample: usize) -> impl Fn(usize) -> F + Copy;
}

/// Speeds that are the same in every lane.
#[derive(Clone, Copy)]
pub(crate) struct Alike<'a, F>(pub(crate) &'a [F]);

impl<F: Float> Course<F> for Alike<'_, F> {
    #[inline(always)]
    fn at(&self, sample: usize) -> impl Fn(usize) -> F + Copy {
        let speed = self.0[sample];
        #[inline(always)]
        move |_| speed
    }
}

/// Speeds that differ between the lanes; a lane without a parameter set is at rest.
#[derive(Clone, Copy)]
pub(crate) struct Own<'a, F> {
    pub(crate) rows: &'a [F],
    pub(crate) sets: usize,
    pub(crate) first: usize,
}

impl<F: Float> Course<F> for Own<'_, F> {
    #[inline(always)]
    fn at(&self, sample: usize) -> impl Fn(usize) -> F + Copy {
        let row = &self.rows[sample * self.sets..][self.first..self.sets];
        let speeds: [F; LANES] = match row.first_chunk() {
            Some(all) => *all,
            None => {
                let mut some = [F::ZERO; LANES];
                some[..row.len()].copy_from_slice(row);
                some
            }
        };
        #[inline(always)]
        move |lane| speeds[lane]
    }
}
