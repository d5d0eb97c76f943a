//! Eccentricity along the motions of several films, integrated in the lanes of vector registers.

use crate::film_path::FilmStep;
use crate::lane::Lane;
use crate::simd::Simd;
use jbf_core::internals::SideBySide;
use jbf_core::law::journal::Journal;
use jbf_core::law::Law;
use jbf_core::stepper::Rk4;
use jbf_core::Real;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Number of films in one block: one vector register of AVX-512.
///
/// Square roots and divisions suffice to keep one register busy. A larger block would have more
/// idle lanes if the films have different numbers of steps.
const LANES: usize = 8;

/// Number of steps that are transposed into lanes at a time.
const TILE: usize = 64;

/// Computes the square of the eccentricity ratio of each film after each of its steps.
///
/// The path of a film is `None` if a step moved its journal out of the bearing. Such a film must be
/// stepped in a scalar type ([`Real::SIDE_BY_SIDE`]).
///
/// Each film starts under the load of its first step. The result is identical bit for bit to that
/// of [`Law::advance`].
pub fn film_paths(films: &[(Journal<f64>, &[FilmStep])], simd: Simd) -> Vec<Option<Vec<f64>>> {
    // Neighbours of similar length waste no lanes.
    let mut order: Vec<usize> = (0..films.len()).collect();
    order.sort_by_key(|&i| Reverse(films[i].1.len()));
    let blocks: Vec<&[usize]> = order.chunks(LANES).collect();
    let done: Vec<Vec<Option<Vec<f64>>>> = blocks
        .par_iter()
        .with_max_len(1)
        .map(|block| {
            let own: Vec<_> = block.iter().map(|&i| films[i]).collect();
            simd.dispatch(
                #[inline(always)]
                || side_by_side(&own),
            )
        })
        .collect();
    let mut paths = vec![None; films.len()];
    for (i, path) in order.iter().zip(done.into_iter().flatten()) {
        paths[*i] = path;
    }
    paths
}

/// Integrates one block of 1 to [`LANES`] films, ordered from the longest to the shortest.
///
/// The remaining lanes repeat the last film.
#[inline(always)]
fn side_by_side(films: &[(Journal<f64>, &[FilmStep])]) -> Vec<Option<Vec<f64>>> {
    let film = |i: usize| films[i.min(films.len() - 1)];
    let laws = core::array::from_fn(|i| film(i).0);
    let starts = core::array::from_fn(|i| {
        let (law, steps) = film(i);
        law.start(steps.first().map_or(law.nominal().load_n, |s| s.load_n))
    });
    let mut lanes = SideBySide::<Lane<f64>, LANES>::new(&laws, &starts);
    let mut paths: Vec<Vec<f64>> = films.iter().map(|f| vec![0.0; f.1.len()]).collect();
    let mut asked = [[[0.0; LANES]; 4]; TILE];
    let mut found = [[0.0; LANES]; TILE];
    for begin in (0..films[0].1.len()).step_by(TILE) {
        sort_in(&mut asked, films, begin);
        for (row, e2) in asked.iter().zip(&mut found) {
            step(&mut lanes, row, e2);
        }
        sort_out(&found, &mut paths, begin);
    }
    let out = lanes.clamped();
    let told = paths.into_iter().zip(out);
    told.map(|(path, left)| (left == 0).then_some(path))
        .collect()
}

/// Transposes the inputs of the steps from `begin` on: from one list per film to one array per
/// step.
///
/// A film without further steps is kept at its position by steps of zero length. This function and
/// [`sort_out`] are not inlined: within the vector code they would become gathers, which take
/// longer than all the steps.
#[inline(never)]
fn sort_in(
    asked: &mut [[[f64; LANES]; 4]; TILE],
    films: &[(Journal<f64>, &[FilmStep])],
    begin: usize,
) {
    for (k, row) in asked.iter_mut().enumerate() {
        let mut last: &[FilmStep] = &[];
        let mut values = [0.0; 4];
        for lane in 0..LANES {
            let steps = films.get(lane).map_or(last, |f| f.1);
            // Neighbours along the same motion are read once.
            if !std::ptr::eq(steps, last) {
                last = steps;
                values = steps.get(begin + k).map_or([0.0; 4], |s| {
                    let [from, middle, to] = s.speed_m_s;
                    [from, middle, to, s.dt_s]
                });
            }
            for (column, value) in row.iter_mut().zip(values) {
                column[lane] = value;
            }
        }
    }
}

/// Transposes the results of the tile that begins at step `begin` into one path per film.
#[inline(never)]
fn sort_out(found: &[[f64; LANES]; TILE], paths: &mut [Vec<f64>], begin: usize) {
    for (lane, path) in paths.iter_mut().enumerate() {
        for (place, row) in path.iter_mut().skip(begin).zip(found) {
            *place = row[lane];
        }
    }
}

/// Advances every film by one step and stores the squares of the eccentricity ratios in `e2`.
#[inline(always)]
fn step(
    lanes: &mut SideBySide<Lane<f64>, LANES>,
    asked: &[[f64; LANES]; 4],
    e2: &mut [f64; LANES],
) {
    for i in 0..LANES {
        let (law, mut film) = (lanes.law(i), lanes.film(i));
        let speeds = [asked[0][i], asked[1][i], asked[2][i]].map(Lane);
        law.advance_inline(&Rk4, &mut film, speeds, Lane::ONE, Lane(asked[3][i]));
        e2[i] = law.film(&film).0;
        lanes.put(i, &film);
    }
}
