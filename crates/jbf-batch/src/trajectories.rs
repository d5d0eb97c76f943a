//! Trajectories of journals with a given accuracy, several in the lanes of vector registers.

use crate::lane::Lane;
use crate::simd::Simd;
use jbf_core::driver::{self, Along, Cost, Excitation, Sample, Start};
use jbf_core::law::journal::Journal;
use jbf_core::Error;

/// Integrates a film along several motions with the given instruction set; see
/// [`jbf_core::driver::follow_side_by_side`].
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
    driver::follow_side_by_side(film, along, start, tolerance, |steps, stages| {
        simd.dispatch(
            #[inline(always)]
            || driver::step_side_by_side::<Lane<f64>, K>(steps, stages),
        );
    })
}
