//! Derivatives of a chain's readings: parameters in groups that one pass carries side by side, and
//! the passes of all runs on all cores.

use super::runs::Slopes;
use super::Chain;
use crate::film_paths::FilmPath;
use crate::motion::Motion;
use crate::share::longest_first;
use jbf_core::{Dual, ParameterError, Real};

/// Derivatives carried side by side in one pass: a law's own, or those of a law with effects. A
/// pass of eight costs a quarter more than one of four, one of twelve three quarters of two passes.
const FEW: usize = 4;
const MANY: usize = 8;
const MOST: usize = 12;

/// Values of a run, and the derivatives of each with respect to some parameters, row by row.
pub type Slice = (Vec<f64>, Vec<f64>);

impl Chain {
    /// For each motion its readings and their derivatives by the parameters `which`.
    pub(super) fn all_slopes(
        &self,
        p: &[f64],
        which: &[usize],
        motions: &[&Motion],
    ) -> Result<Vec<Slice>, ParameterError> {
        let groups: Vec<&[usize]> = match which.len() {
            0 => vec![&[]],
            MANY..=MOST => vec![which],
            _ => which.chunks(MANY).collect(),
        };
        let paths = self.film_paths(p, true, motions)?;
        let jobs: Vec<(usize, usize)> = (0..motions.len())
            .flat_map(|m| (0..groups.len()).map(move |g| (m, g)))
            .collect();
        let done = longest_first(
            &jobs,
            |&(m, _)| motions[m].len(),
            |&(m, g)| self.slopes(p, groups[g], motions[m], paths[m].as_deref()),
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

    /// Values and derivatives with respect to at most `MOST` parameters along one run.
    fn slopes(
        &self,
        p: &[f64],
        which: &[usize],
        motion: &Motion,
        path: Option<&FilmPath>,
    ) -> Result<Slice, ParameterError> {
        match which.len() {
            n if n <= FEW => self.slopes_of::<FEW>(p, which, motion, path),
            n if n <= MANY => self.slopes_of::<MANY>(p, which, motion, path),
            _ => self.slopes_of::<MOST>(p, which, motion, path),
        }
    }

    fn slopes_of<const LANES: usize>(
        &self,
        p: &[f64],
        which: &[usize],
        motion: &Motion,
        path: Option<&FilmPath>,
    ) -> Result<Slice, ParameterError> {
        let lifted: Vec<Dual<LANES>> = p
            .iter()
            .enumerate()
            .map(|(i, &v)| match which.iter().position(|&w| w == i) {
                Some(lane) => Dual::parameter(v, lane),
                None => Dual::of(v),
            })
            .collect();
        let (values, lanes) = self.run(&lifted, Slopes, motion, path)?;
        let rows = lanes.iter().flat_map(|row| row[..which.len()].iter());
        Ok((values, rows.copied().collect()))
    }
}

/// One matrix of `n` rows out of blocks of columns.
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
