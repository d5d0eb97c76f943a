//! Property: a trajectory along any sine or record, with any tolerance, is finite.

use crate::bytes::{between, parameter};
use crate::steps;
use arbitrary::{Result, Unstructured};
use jbf_core::driver::{follow, Excitation, Film, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Named;
use jbf_core::{Bearing, Clock};

/// Number of samples of a trajectory; a few are sufficient to test that it is finite.
const SAMPLES: usize = 12;

/// Largest number of integration steps of a trajectory with `SAMPLES` samples.
const MOST_STEPS: u32 = 2_000_000;

fn along<F: Film<f64, N>, E: Excitation, const N: usize>(
    film: &F,
    excitation: &E,
    start: &Start<f64>,
    times_s: &[f64],
    tolerance: f64,
) {
    let mut seen = 0;
    let done = follow(
        film,
        excitation,
        start,
        times_s,
        tolerance,
        |i, sample: &Sample<f64>| {
            assert_eq!(i, seen, "samples come in order");
            seen += 1;
            steps::seen();
            assert!(
                sample.eps >= 0.0 && sample.eps < 1.0,
                "{sample:?} {start:?} {tolerance}"
            );
            assert!(sample.coefficient.is_finite(), "{sample:?}");
        },
    );
    let told = || format!("{start:?} {tolerance} {times_s:?}");
    if let Ok(cost) = done {
        assert_eq!(seen, times_s.len(), "{}", told());
        assert!(
            cost.steps + cost.rejected < MOST_STEPS,
            "{cost:?} {}",
            told()
        );
    }
}

pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    let mut value = |i: usize| parameter(bytes, &<Journal<f64> as Named<f64>>::INFO.parameters[i]);
    let parameters = Parameters {
        f_m: value(0)?,
        // Beyond these values a journal of this mass physically oscillates for millions of periods.
        u_tr_m_s: value(1)?.clamp(1e-3, 1.0),
        k0: value(2)?,
        gamma: value(3)?,
    };
    let load_n = between(bytes, 10.0, 1e4)?;
    let eps = if bytes.arbitrary()? {
        Some(between(bytes, 0.01, 0.999)?)
    } else {
        None
    };
    let start = Start {
        eps,
        phi_rad: between(bytes, -3.2, 3.2)?,
        ..Start::default()
    };
    let tolerance = between(bytes, 1e-12, 1.0)?;
    let spacing_s = between(bytes, 1e-4, 0.3)?;
    let times_s: [f64; SAMPLES] = core::array::from_fn(|i| spacing_s * i as f64);
    let mut speeds = [0.0; SAMPLES];
    for speed in &mut speeds {
        *speed = between(bytes, -1.0, 1.0)?;
    }
    let sine = Sine::with_bias(
        between(bytes, 0.0, 1.0)?,
        between(bytes, 1e-3, 30.0)?,
        between(bytes, -1.0, 1.0)?,
    );
    let (Ok(sine), Ok(record)) = (sine, Sampled::new(&times_s, &speeds)) else {
        return Ok(());
    };
    let (reduced, along_sine) = (bytes.arbitrary()?, bytes.arbitrary::<bool>()?);
    let bearing = Bearing::THESIS;
    if reduced {
        let Ok(film) = Journal::new(&bearing, load_n, &parameters, Clock::Journal) else {
            return Ok(());
        };
        if along_sine {
            along(&film, &sine, &start, &times_s, tolerance);
        } else {
            along(&film, &record, &start, &times_s, tolerance);
        }
    } else {
        let Ok(film) = JournalFull::new(&bearing, load_n, &parameters, Clock::Journal) else {
            return Ok(());
        };
        if along_sine {
            along(&film, &sine, &start, &times_s, tolerance);
        } else {
            along(&film, &record, &start, &times_s, tolerance);
        }
    }
    Ok(())
}
