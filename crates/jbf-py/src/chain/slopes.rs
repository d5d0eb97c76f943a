//! Derivatives of the readings of a chain with respect to its parameters.
//!
//! Parameters are processed in groups, one per pass over a run, and the passes of all runs are
//! distributed to all cores.

use super::Chain;
use crate::film_paths::FilmPath;
use crate::motion::Motion;
use crate::share::longest_first;
use jbf_core::Error;
use jbf_predict::parameter_passes;

/// Readings of a run, and their derivatives with respect to some parameters, one row per sample.
pub type Slice = (Vec<f64>, Vec<f64>);

impl Chain {
    /// Computes the readings and their derivatives with respect to the parameters `which`, for each
    /// motion.
    pub(super) fn all_slopes(
        &self,
        p: &[f64],
        which: &[usize],
        motions: &[&Motion],
    ) -> Result<Vec<Slice>, Error> {
        let groups = parameter_passes(which);
        let paths = self.film_paths(p, true, motions)?;
        let jobs: Vec<(usize, usize)> = (0..motions.len())
            .flat_map(|m| (0..groups.len()).map(move |g| (m, g)))
            .collect();
        let done = longest_first(
            &jobs,
            |&(m, _)| motions[m].len(),
            |&(m, g)| {
                let path = paths[m].as_deref().map(FilmPath::kept);
                self.model()
                    .derivatives(p, groups[g], &motions[m].record(), path)
            },
        )?;
        let mut done = done.into_iter();
        let mut out = Vec::with_capacity(motions.len());
        for motion in motions {
            let mut parts: Vec<Slice> = done.by_ref().take(groups.len()).collect();
            let matrix = side_by_side(&parts, motion.len(), which.len());
            out.push((parts.swap_remove(0).0, matrix));
        }
        Ok(out)
    }
}

/// Joins the derivatives of several passes into one matrix of `n` rows and `columns` columns.
fn side_by_side(parts: &[Slice], n: usize, columns: usize) -> Vec<f64> {
    if let [(_, only)] = parts {
        return only.clone();
    }
    let mut matrix = vec![0.0; n * columns];
    let mut first = 0;
    for (values, slopes) in parts {
        let width = slopes.len() / values.len().max(1);
        if width > 0 {
            for (row, own) in matrix.chunks_mut(columns).zip(slopes.chunks(width)) {
                row[first..first + width].copy_from_slice(own);
            }
        }
        first += width;
    }
    matrix
}
