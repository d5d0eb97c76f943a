//! The imposed motion: one for all sets, or one a set.

use crate::lane::Float;
use crate::part::LANES;

/// Surface speed, m/s, at samples one step apart.
#[derive(Clone, Copy, Debug)]
pub enum Speeds<'a, F> {
    /// One motion for every set.
    Common(&'a [F]),
    /// One motion a set: row by row, a row for each sample, `sets` values wide.
    Each {
        /// The rows.
        rows: &'a [F],
        /// Values in a row.
        sets: usize,
    },
}

impl<F: Float> Speeds<'_, F> {
    /// Samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Common(speeds) => speeds.len(),
            Self::Each { rows, sets } => rows.len() / (*sets).max(1),
        }
    }

    /// True for no sample at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The speeds of one block: what the inner loop sees of [`Speeds`], so that a common speed is
/// one number to it.
pub(crate) trait Course<F> {
    /// Speed of each lane at a sample.
    fn at(&self, sample: usize) -> impl Fn(usize) -> F + Copy;
}

/// Every lane alike.
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

/// Each lane its own; lanes without a set rest.
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
