//! Cache of the states of films along one motion.
//!
//! A diagnosis tries each of thirty effects with the same film, and a search returns to earlier
//! parameters.
//!
//! The key of a path contains every number on which it depends, bit for bit, so that the cache does
//! not change any result (python/tests/estimation/test_transients.py).

use jbf_batch::film_path::{FilmStep, Place};
use jbf_core::{Bearing, Clock};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Number of cached paths per motion; a search alternates between a few parameter sets.
const KEPT: usize = 4;

/// Largest number of cached states in one process, of 24 bytes each; further paths are computed
/// each time.
const MOST_PLACES: usize = 12_000_000;

static PLACES: AtomicUsize = AtomicUsize::new(0);

/// Key of a cached path: all quantities, except the motion, on which the states of a film depend.
#[derive(Clone, Copy, PartialEq)]
pub struct Film {
    pub bearing: Option<Bearing>,
    pub load_n: Option<f64>,
    pub clock: Clock,
    /// Parameters of the film and longest inner step, s, as bit patterns.
    pub bits: [u64; 3],
}

/// States of a film along a motion, with or without derivatives.
///
/// It also contains, for each sample that a step leads to, the index of that step.
pub struct FilmPath {
    pub places: Vec<Place>,
    pub has_slopes: bool,
    pub ends: Arc<[u32]>,
}

impl FilmPath {
    /// Returns the path in the form for a prediction.
    pub fn kept(&self) -> jbf_predict::FilmPath<'_> {
        jbf_predict::FilmPath {
            places: &self.places,
            ends: &self.ends,
        }
    }
}

/// Integration steps of a film along a motion, and whether the load is constant.
pub struct Steps {
    pub every: Vec<FilmStep>,
    pub one_load: bool,
    pub ends: Arc<[u32]>,
}

/// Content of the cache along one motion.
#[derive(Default)]
struct Kept {
    /// Paths with their keys, the most recently used last.
    paths: VecDeque<(Film, Arc<FilmPath>)>,
    /// Integration steps, with their greatest length, s.
    steps: Option<(f64, Arc<Steps>)>,
}

/// Cache of paths and integration steps along one motion.
#[derive(Default)]
pub struct FilmPaths(Mutex<Kept>);

impl FilmPaths {
    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the integration steps of at most `longest_s`, from the cache or from `make`.
    pub fn steps(&self, longest_s: f64, make: impl FnOnce() -> Steps) -> Arc<Steps> {
        if let Some((of, steps)) = &self.lock().steps {
            if *of == longest_s {
                return Arc::clone(steps);
            }
        }
        let made = Arc::new(make());
        self.lock().steps = Some((longest_s, Arc::clone(&made)));
        made
    }

    /// Returns the path of a film if it is cached, and has derivatives if `with_slopes`.
    pub fn kept(&self, film: &Film, with_slopes: bool) -> Option<Arc<FilmPath>> {
        let paths = &mut self.lock().paths;
        let at = paths
            .iter()
            .position(|(of, path)| of == film && (path.has_slopes || !with_slopes))?;
        let entry = paths.remove(at)?;
        let path = Arc::clone(&entry.1);
        paths.push_back(entry);
        Some(path)
    }

    /// Stores the path of a film in the cache.
    ///
    /// The path replaces one of the same film or, if the cache is full, the least recently used
    /// path.
    pub fn keep(&self, film: Film, path: Arc<FilmPath>) {
        let paths = &mut self.lock().paths;
        if let Some(at) = paths.iter().position(|(of, _)| *of == film) {
            forget(paths.remove(at));
        }
        while paths.len() >= KEPT {
            forget(paths.pop_front());
        }
        let count = path.places.len();
        if PLACES.fetch_add(count, Ordering::Relaxed) + count > MOST_PLACES {
            PLACES.fetch_sub(count, Ordering::Relaxed);
            // Makes room for this film's path the next time, instead of keeping the least recently
            // used path.
            forget(paths.pop_front());
            return;
        }
        paths.push_back((film, path));
    }
}

impl Drop for FilmPaths {
    fn drop(&mut self) {
        let paths = &mut self.lock().paths;
        while let Some(entry) = paths.pop_front() {
            forget(Some(entry));
        }
    }
}

fn forget(entry: Option<(Film, Arc<FilmPath>)>) {
    if let Some((_, path)) = entry {
        PLACES.fetch_sub(path.places.len(), Ordering::Relaxed);
    }
}
