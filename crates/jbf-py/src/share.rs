//! Distribution of jobs of different sizes to all cores.
//!
//! The longest jobs are started first, so that all cores finish at about the same time.

use rayon::prelude::*;
use std::cmp::Reverse;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Applies `work` to every job in parallel and returns the results in the order of `jobs`.
///
/// # Errors
/// The first error, in the order of `jobs`.
pub fn longest_first<J: Sync, R: Send, E: Send>(
    jobs: &[J],
    size: impl Fn(&J) -> usize,
    work: impl Fn(&J) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let mut order: Vec<usize> = (0..jobs.len()).collect();
    order.sort_by_key(|&i| Reverse(size(&jobs[i])));
    let next = AtomicUsize::new(0);
    let mut done: Vec<(usize, Result<R, E>)> = (0..rayon::current_num_threads().min(jobs.len()))
        .into_par_iter()
        .with_max_len(1)
        .flat_map_iter(|_| {
            std::iter::from_fn(|| {
                let &i = order.get(next.fetch_add(1, Ordering::Relaxed))?;
                Some((i, work(&jobs[i])))
            })
        })
        .collect();
    done.sort_by_key(|&(i, _)| i);
    done.into_iter().map(|(_, answer)| answer).collect()
}
