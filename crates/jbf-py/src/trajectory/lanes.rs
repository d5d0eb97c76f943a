//! Integration of several runs of a film without inertia in the lanes of vector registers.

use super::{one, Imposed, Result1, Run};
use jbf_batch::{follow_side_by_side, Along, Simd};
use jbf_core::driver::{Cost, Excitation, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::Journal;
use jbf_core::Error;
use rayon::prelude::*;

/// Number of runs that are integrated in parallel lanes.
///
/// With eight, the serial output of the samples takes as long as the wider register saves.
const LANES: usize = 4;

/// Smallest number of runs for which lanes are faster than a serial integration.
const WORTH: usize = 3;

/// Integrates all runs on all threads; the result is identical bit for bit to that of a serial
/// integration.
pub fn all_in_lanes(
    film: &Journal<f64>,
    runs: &[Run],
    start: &Start<f64>,
    tolerance: f64,
) -> Result<Vec<Result1>, Error> {
    // Group runs of the same kind.
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by_key(|&i| matches!(runs[i].imposed, Imposed::Record(_)));
    let share = runs.len().div_ceil(rayon::current_num_threads());
    let groups: Vec<Vec<usize>> = order
        .chunk_by(|&a, &b| is_record(&runs[a]) == is_record(&runs[b]))
        .flat_map(|kind| dealt(kind, share.clamp(1, LANES)))
        .collect();
    let done: Vec<Vec<Result1>> = groups
        .par_iter()
        .with_max_len(1)
        .map(|group| {
            let own: Vec<&Run> = group.iter().map(|&i| &runs[i]).collect();
            together(film, &own, start, tolerance)
        })
        .collect::<Result<_, _>>()?;
    let mut found: Vec<(usize, Result1)> = groups
        .into_iter()
        .flatten()
        .zip(done.into_iter().flatten())
        .collect();
    found.sort_by_key(|&(i, _)| i);
    Ok(found.into_iter().map(|(_, result)| result).collect())
}

/// Divides run indices into groups of at most `most`, with adjacent runs in different groups,
/// because similar runs take similar times.
fn dealt(runs: &[usize], most: usize) -> Vec<Vec<usize>> {
    let groups = runs.len().div_ceil(most);
    (0..groups)
        .map(|k| runs.iter().copied().skip(k).step_by(groups).collect())
        .collect()
}

fn is_record(run: &Run) -> bool {
    matches!(run.imposed, Imposed::Record(_))
}

/// Integrates a group of runs of one kind of motion, at most [`LANES`].
fn together(
    film: &Journal<f64>,
    runs: &[&Run],
    start: &Start<f64>,
    tolerance: f64,
) -> Result<Vec<Result1>, Error> {
    if runs.len() < WORTH {
        return runs
            .iter()
            .map(|run| one(film, run, start, tolerance))
            .collect();
    }
    let sines: Vec<Sine> = runs
        .iter()
        .filter_map(|run| match run.imposed {
            Imposed::Sine((amplitude, omega, bias)) => {
                Some(Sine::with_bias(amplitude, omega, bias))
            }
            Imposed::Record(_) => None,
        })
        .collect::<Result<_, _>>()?;
    if sines.len() == runs.len() {
        return in_lanes(film, &sines, runs, start, tolerance);
    }
    let records: Vec<Sampled<'_>> = runs
        .iter()
        .filter_map(|run| match &run.imposed {
            Imposed::Record((time_s, velocity_m_s)) => Some(Sampled::new(time_s, velocity_m_s)),
            Imposed::Sine(_) => None,
        })
        .collect::<Result<_, _>>()?;
    in_lanes(film, &records, runs, start, tolerance)
}

fn in_lanes<E: Excitation>(
    film: &Journal<f64>,
    motions: &[E],
    runs: &[&Run],
    start: &Start<f64>,
    tolerance: f64,
) -> Result<Vec<Result1>, Error> {
    let mut found: Vec<Result1> = runs
        .iter()
        .map(|run| {
            let zeros = || vec![0.0; run.time_s.len()];
            Result1 {
                coefficient: zeros(),
                x: zeros(),
                y: zeros(),
                slopes: Vec::new(),
                cost: Cost::default(),
            }
        })
        .collect();
    let mut each = motions.iter().zip(runs).zip(&mut found);
    let along = [(); LANES].map(|()| {
        each.next().map(|((excitation, run), out)| Along {
            excitation,
            times_s: run.time_s.as_slice(),
            sink: move |i: usize, sample: &Sample<f64>| {
                out.coefficient[i] = sample.coefficient;
                [out.x[i], out.y[i]] = sample.xy.into();
            },
        })
    });
    let costs = follow_side_by_side(film, along, start, tolerance, Simd::best())?;
    for (out, cost) in found.iter_mut().zip(costs) {
        out.cost = cost;
    }
    Ok(found)
}
