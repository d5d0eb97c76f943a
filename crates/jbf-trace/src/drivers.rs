//! Fingerprints (hashes of results) of trajectories with a given accuracy.

use crate::hash::Hash;
use jbf_core::driver::{follow, Film, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::{Bearing, Clock, Real};

/// Number of samples of a trajectory.
const SAMPLES: usize = 64;

fn hashed<T: Real, F: Film<T, N>, const N: usize>(film: &F, tolerance: f64) -> [Hash; 2] {
    let times_s: [f64; SAMPLES] = core::array::from_fn(|i| 0.0625 * i as f64);
    let speeds: [f64; SAMPLES] = core::array::from_fn(|i| 0.1 * Real::sin(0.2 * i as f64));
    let start = Start::default();
    let mut hashes = [Hash::default(); 2];
    let [sine, sampled] = &mut hashes;
    if let Ok(motion) = Sine::with_bias(0.127, 2.0, 0.01) {
        let sink = |_, sample: &Sample<T>| sine.take(sample.coefficient);
        let _ = follow(film, &motion, &start, &times_s, tolerance, sink);
    }
    if let Ok(motion) = Sampled::new(&times_s, &speeds) {
        let sink = |_, sample: &Sample<T>| sampled.take(sample.coefficient);
        let _ = follow(film, &motion, &start, &times_s, tolerance, sink);
    }
    hashes
}

/// Passes the fingerprints of both film models to `take`, along a sine and along a record.
pub(crate) fn drivers<T: Real>(take: &mut dyn FnMut(&'static str, &'static str, Hash)) {
    let p = Parameters::TABLE_4_2;
    let parameters = Parameters {
        f_m: T::of(p.f_m),
        u_tr_m_s: T::of(p.u_tr_m_s),
        k0: T::of(p.k0),
        gamma: T::of(p.gamma),
    };
    let bearing = Bearing::THESIS;
    let tolerance = 1e-4;
    if let Ok(film) = Journal::<T>::new(&bearing, 104.0, &parameters, Clock::Journal) {
        let [sine, sampled] = hashed(&film, tolerance);
        take("driver", "journal/sine", sine);
        take("driver", "journal/record", sampled);
    }
    if let Ok(film) = JournalFull::<T>::new(&bearing, 104.0, &parameters, Clock::Journal) {
        let [sine, sampled] = hashed(&film, tolerance);
        take("driver", "journal_full/sine", sine);
        take("driver", "journal_full/record", sampled);
    }
}
