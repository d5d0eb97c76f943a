//! Trajectories of journals with a given accuracy, several in the lanes of vector registers.

use crate::lane::Lane;
use crate::simd::Simd;
use jbf_core::driver::{Cost, Excitation, Sample, Start};
use jbf_core::internals::{self, Along};
use jbf_core::law::journal::Journal;
use jbf_core::Error;

/// Integrates `film` along at most `K` motions from one start with the given instruction set.
///
/// The result is identical bit for bit to that of [`jbf_core::driver::follow`] along each motion.
///
/// # Errors
/// As [`jbf_core::driver::trajectory`].
pub fn follow_side_by_side<E: Excitation, S: FnMut(usize, &Sample<f64>), const K: usize>(
    film: &Journal<f64>,
    along: [Option<Along<'_, E, S>>; K],
    start: &Start<f64>,
    tolerance: f64,
    simd: Simd,
) -> Result<[Cost; K], Error> {
    internals::follow_side_by_side(film, along, start, tolerance, |steps, stages| {
        simd.dispatch(
            #[inline(always)]
            || internals::step_side_by_side::<Lane<f64>, K>(steps, stages),
        );
    })
}
