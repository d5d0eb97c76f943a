//! Imposed motion: one for all sets, or one per set.

use crate::lane::Float;
use crate::part::LANES;

/// Surface speed, m/s, at equally spaced samples.
#[derive(Clone, Copy, Debug)]
pub enum Speeds<'a, F> {
    /// One motion for every set.
    Common(&'a [F]),
    /// One motion per set, in rows: one row per sample, with `sets` values.
    Each {
        /// Rows of speeds.
        rows: &'a [F],
        /// Number of values in a row.
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

/// Speeds of one block: the part of [`Speeds`] that the inner loop uses, in which a common speed is
/// a single number.
pub(crate) trait Course<F> {
    /// Speed of each lane at a sample.
    fn at(&self, sample: usize) -> impl Fn(usize) -> F + Copy;
}

/// The same speed in every lane.
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

/// A separate speed in each lane; lanes without a set are at rest.
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
