//! The paths of several films, each along a motion of its own, in lanes.

use crate::lane::Lane;
use crate::simd::Simd;
use jbf_core::film_path::FilmStep;
use jbf_core::law::journal::{Journal, SideBySide};
use jbf_core::law::Law;
use jbf_core::stepper::Rk4;
use jbf_core::Real;
use rayon::prelude::*;
use std::cmp::Reverse;

/// Films in one block: one register of AVX-512, which roots and divisions keep busy by themselves; and
/// of few films of unlike lengths few wait for others.
const LANES: usize = 8;

/// Steps sorted into lanes at a time.
const TILE: usize = 64;

/// Square of the eccentricity ratio after every step, of each film; none of a film that a step carried
/// out of its bearing, where it must be stepped alone ([`Real::SIDE_BY_SIDE`]).
///
/// The load of a film is that of its first step. The bits are those of [`Law::advance`].
pub fn film_paths(films: &[(Journal<f64>, &[FilmStep])], simd: Simd) -> Vec<Option<Vec<f64>>> {
    // Neighbours of one length waste no lanes.
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

/// At least one film and at most [`LANES`], the longest first; the lanes beyond them repeat the last.
#[inline(always)]
fn side_by_side(films: &[(Journal<f64>, &[FilmStep])]) -> Vec<Option<Vec<f64>>> {
    let film = |i: usize| films[i.min(films.len() - 1)];
    let laws = core::array::from_fn(|i| film(i).0);
    let starts = core::array::from_fn(|i| {
        let (law, steps) = film(i);
        law.start(steps.first().map_or(law.nominal().load_n(), |s| s.load_n))
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

/// The steps from `begin` on; a film that has come to its end stays where it is, in steps of no
/// length.
///
/// A function of its own, as the next: wide instructions make gathers of it, which cost more than
/// all the steps.
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
            // Neighbours that go along one motion ask once.
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

/// The films' places of a tile that begins at `begin`.
#[inline(never)]
fn sort_out(found: &[[f64; LANES]; TILE], paths: &mut [Vec<f64>], begin: usize) {
    for (lane, path) in paths.iter_mut().enumerate() {
        for (place, row) in path.iter_mut().skip(begin).zip(found) {
            *place = row[lane];
        }
    }
}

/// One step of every film.
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
