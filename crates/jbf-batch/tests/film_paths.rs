//! Tests that film paths computed in lanes equal those computed one by one, bit for bit, with every
//! instruction set.

use jbf_batch::film_path::FilmStep;
use jbf_batch::{film_paths, Simd};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Law;
use jbf_core::{Bearing, Clock};

fn law(i: usize, k0: f64) -> Journal<f64> {
    let parameters = Parameters {
        u_tr_m_s: 0.05 + 0.001 * i as f64,
        k0,
        ..Parameters::TABLE_4_2
    };
    Journal::new(&Bearing::THESIS, 104.0, &parameters, Clock::Journal).expect("valid")
}

/// Creates steps of different lengths, under a load that differs from that of the law's
/// constructor.
fn steps(count: usize, motion: usize, longest_s: f64) -> Vec<FilmStep> {
    let speed = |t: f64| 0.127 * (t * (0.4 + 0.3 * motion as f64)).sin().abs();
    let mut time_s = 0.0;
    (0..count)
        .map(|i| {
            let dt_s = longest_s * (1.0 + (i % 5) as f64) / 5.0;
            let at = |share: f64| speed(time_s + share * dt_s);
            let step = FilmStep {
                speed_m_s: [at(0.0), at(0.5), at(1.0)],
                dt_s,
                load_n: 80.0 + 10.0 * motion as f64,
            };
            time_s += dt_s;
            step
        })
        .collect()
}

fn alone(law: &Journal<f64>, steps: &[FilmStep]) -> Vec<f64> {
    let mut film = law.start(steps[0].load_n);
    let place = |s: &FilmStep| {
        law.advance(&mut film, s.speed_m_s, 1.0, s.dt_s);
        law.film(&film)
    };
    steps.iter().map(place).collect()
}

#[test]
fn film_path_in_a_batch_equals_that_computed_alone_bit_for_bit() {
    // Fewer films than a block, exactly a block, and more; with separate or shared motions.
    for count in [1, 7, 16, 30, 45] {
        let motions: Vec<Vec<FilmStep>> = (0..count)
            .map(|m| steps(50 + 37 * (m % 6), m / 5, 0.02))
            .collect();
        let films: Vec<(Journal<f64>, &[FilmStep])> = (0..count)
            .map(|i| (law(i, 7.5e5), motions[i / 3 * 3].as_slice()))
            .collect();
        for simd in Simd::available() {
            for ((law, steps), path) in films.iter().zip(film_paths(&films, simd)) {
                assert_eq!(path.expect("inside"), alone(law, steps), "{}", simd.name());
            }
        }
    }
}

/// Only the film whose journal leaves its bearing in a coarse step has no path.
#[test]
fn film_that_leaves_the_bearing_has_no_path_and_others_keep_theirs() {
    let coarse = steps(200, 1, 5.0);
    let films = [
        (law(0, 7.5e5), coarse.as_slice()),
        (law(1, 7.5e5), &coarse[..0]),
    ];
    let paths = film_paths(&films, Simd::best());
    assert_eq!(paths[0], None);
    assert_eq!(paths[1], Some(vec![]));
}

#[test]
fn batch_without_films_has_no_paths() {
    assert!(film_paths(&[], Simd::best()).is_empty());
}
