//! States of the film along motions, which chains that differ only in later stages share.
//!
//! Their derivatives with respect to the two parameters of the film are finite differences of paths
//! that are computed in parallel. The relative error of a derivative is about 1e-6, negligible for
//! searches and standard errors. Three lanes of one register take a fifth of the time of dual
//! numbers.

use super::Chain;
use crate::film_paths::{Film, FilmPath, Steps};
use crate::motion::Motion;
use jbf_batch::film_path::{FilmStep, FilmSteps, Place};
use jbf_batch::{film_paths, Simd};
use jbf_catalogue::Using;
use jbf_core::effect::Stage;
use jbf_core::law::journal::Journal;
use jbf_core::law::{Law, Named};
use jbf_core::{internals, run, Error};
use std::cell::RefCell;
use std::sync::Arc;

/// Relative perturbation of a film parameter for a finite difference; a power of two is exact.
const APART: f64 = 1.0 / 1_048_576.0;

/// Indices of the parameters of the film in the description of the journal law.
const BY: Option<[usize; 2]> = <Journal<f64> as Law<f64>>::FILM_PARAMETERS;

type Path = Option<Arc<FilmPath>>;

impl Chain {
    /// Returns the path of the film of this chain along each motion.
    ///
    /// There is no path in any of these cases:
    ///
    /// - The law has no film path.
    /// - An effect at an earlier stage changes the film.
    /// - The load varies within the run.
    /// - The journal left the bearing in a step.
    pub(super) fn film_paths(
        &self,
        p: &[f64],
        with_slopes: bool,
        motions: &[&Motion],
    ) -> Result<Vec<Path>, Error> {
        let before_film = |stage| matches!(stage, Stage::Drive | Stage::Lubricant | Stage::Film);
        let (Some(by), true) = (BY, self.law.name == <Journal<f64> as Named<f64>>::INFO.name)
        else {
            return Ok(vec![None; motions.len()]);
        };
        if self.effects.iter().any(|e| before_film(e.stage)) {
            return Ok(vec![None; motions.len()]);
        }
        let max_step_s = self.max_step_s;
        let inner_s = self.model().with_chain(
            p,
            LongestInnerStep {
                max_step_s,
                motions,
            },
        )?;
        let film = |i: usize| Film {
            bearing: self.bearing,
            load_n: self.load_n,
            clock: self.clock,
            bits: [p[by[0]], p[by[1]], inner_s[i]].map(f64::to_bits),
        };
        let mut paths: Vec<Path> = Vec::with_capacity(motions.len());
        let mut missing: Vec<(usize, Arc<Steps>)> = Vec::new();
        for (i, motion) in motions.iter().enumerate() {
            let kept = motion.film_paths().kept(&film(i), with_slopes);
            if kept.is_none() {
                let steps = motion
                    .film_paths()
                    .steps(inner_s[i], || steps_of(motion, inner_s[i]));
                if steps.one_load {
                    missing.push((i, steps));
                }
            }
            paths.push(kept);
        }
        let laws = self.laws(p, by, with_slopes)?;
        let films: Vec<(Journal<f64>, &[FilmStep])> = missing
            .iter()
            .flat_map(|(_, steps)| laws.iter().map(|&law| (law, steps.every.as_slice())))
            .collect();
        let mut traced = film_paths(&films, Simd::best()).into_iter();
        for (i, steps) in &missing {
            let lanes: Option<Vec<Vec<f64>>> = traced
                .by_ref()
                .take(laws.len())
                .collect::<Vec<_>>()
                .into_iter()
                .collect();
            let Some(lanes) = lanes else { continue };
            let path = Arc::new(FilmPath {
                places: joined(&lanes, by.map(|n| APART * p[n])),
                has_slopes: with_slopes,
                ends: Arc::clone(&steps.ends),
            });
            motions[*i].film_paths().keep(film(*i), Arc::clone(&path));
            paths[*i] = Some(path);
        }
        Ok(paths)
    }

    /// Returns the law, followed, if `with_slopes`, by the law with each film parameter perturbed.
    fn laws(
        &self,
        p: &[f64],
        by: [usize; 2],
        with_slopes: bool,
    ) -> Result<Vec<Journal<f64>>, Error> {
        let values = &p[..self.law.parameters.len()];
        let law = |moved: Option<(usize, f64)>| {
            let mut own = values.to_vec();
            if let Some((which, factor)) = moved {
                own[which] *= factor;
            }
            <Journal<f64> as Named<f64>>::build(
                self.bearing.as_ref(),
                self.load_n,
                &own,
                self.clock,
            )
        };
        let beside = by.iter().filter(|_| with_slopes);
        let moved = beside.map(|&which| Some((which, 1.0 + APART)));
        std::iter::once(None).chain(moved).map(law).collect()
    }
}

/// Combines the path of the film and the perturbed paths into states with derivatives.
///
/// `apart` contains the perturbations of the parameters.
fn joined(lanes: &[Vec<f64>], apart: [f64; 2]) -> Vec<Place> {
    let own = lanes[0].iter().copied().enumerate();
    own.map(|(k, film)| {
        let slope = |n: usize| {
            let beside = lanes.get(n + 1);
            beside.map_or(0.0, |moved| (moved[k] - film) / apart[n])
        };
        Place {
            film,
            slopes: [slope(0), slope(1)],
        }
    })
    .collect()
}

/// Integration steps of a film along a motion with inner steps of at most `inner_s`.
fn steps_of(motion: &Motion, inner_s: f64) -> Steps {
    let every = RefCell::new(Vec::with_capacity(motion.len() * 9 / 8));
    let asks = jbf_core::Chain::new(FilmSteps::new(|s| every.borrow_mut().push(s)));
    let mut ends = Vec::with_capacity(motion.len());
    let mut before = 0;
    run::predict(&asks, &motion.record(), inner_s, |i, _| {
        let made = every.borrow().len();
        // Samples at the same instant have no step between them, and no end.
        if i > 0 && made > before {
            // A path with more steps than a u32 can count would not fit into memory.
            ends.push((made - 1) as u32);
        }
        before = made;
    });
    let every = every.into_inner();
    let first = motion.record().load_n.first().copied();
    let one_load = every.iter().all(|s: &FilmStep| Some(s.load_n) == first);
    Steps {
        every,
        one_load,
        ends: ends.into(),
    }
}

/// Computes the longest inner step along each motion, s.
struct LongestInnerStep<'a> {
    max_step_s: f64,
    motions: &'a [&'a Motion],
}

impl Using<f64> for LongestInnerStep<'_> {
    type Output = Vec<f64>;

    fn with<L: Named<f64>>(self, chain: jbf_core::Chain<f64, L>) -> Vec<f64> {
        let along = |m: &&Motion| internals::inner_step_s(&chain, &m.record(), self.max_step_s);
        self.motions.iter().map(along).collect()
    }
}
