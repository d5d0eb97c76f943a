//! The paths that films have gone along one motion, kept: of the thirty effects that stand behind the
//! film each is tried on the same path, and a search comes back to where it was.
//!
//! A path is found by every number that it depends on, to the bit, so that what is kept changes no
//! answer (python/tests/estimation/test_film_rate.py).

use jbf_core::film_path::{FilmStep, Place};
use jbf_core::{Bearing, Clock};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Paths kept along one motion: a search goes between a few places.
const KEPT: usize = 4;

/// Places kept by one process, of 24 bytes each. Beyond them a path is made anew each time.
const MOST_PLACES: usize = 12_000_000;

static PLACES: AtomicUsize = AtomicUsize::new(0);

/// What the path of a journal's film depends on, beside the motion.
#[derive(Clone, Copy, PartialEq)]
pub struct Film {
    pub bearing: Option<Bearing>,
    pub load_n: Option<f64>,
    pub clock: Clock,
    /// The film's parameters, and the longest inner step, s, bit by bit.
    pub bits: [u64; 3],
}

/// The places of a film, with slopes or without, and of each sample that a step leads to the number
/// of that step.
pub struct FilmPath {
    pub places: Vec<Place>,
    pub has_slopes: bool,
    pub ends: Arc<[u32]>,
}

impl FilmPath {
    /// The path as a prediction takes it.
    pub fn kept(&self) -> jbf_predict::FilmPath<'_> {
        jbf_predict::FilmPath {
            places: &self.places,
            ends: &self.ends,
        }
    }
}

/// What a motion asks of a film, and whether all of it is under one load.
pub struct Steps {
    pub every: Vec<FilmStep>,
    pub one_load: bool,
    pub ends: Arc<[u32]>,
}

/// What is kept along one motion.
#[derive(Default)]
struct Kept {
    /// Paths by their film, the last one used last.
    paths: VecDeque<(Film, Arc<FilmPath>)>,
    /// The steps, by the longest of them, s.
    steps: Option<(f64, Arc<Steps>)>,
}

/// The paths and steps along one motion.
#[derive(Default)]
pub struct FilmPaths(Mutex<Kept>);

impl FilmPaths {
    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The steps of at most this length, s: those of the last time, or made.
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

    /// The path of a film, if it is kept, with its slopes where they are asked for.
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

    /// Keep the path of a film, in place of one without slopes or of the one left longest ago.
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
            // Rather this film's than one left long ago, the next time.
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
