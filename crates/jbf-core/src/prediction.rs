//! Prediction of the friction along a whole record by a signal chain, with inner steps between the
//! samples.

use crate::chain::{Chain, State, SHORTEST_STEP_S};
use crate::effect::{Effect, Rig, Signal};
use crate::law::Law;
use crate::motion::{crossing, Motion};
use crate::real::Real;
use crate::record::Record;

/// Shortest inner step that a film may require, s.
///
/// It limits the time of a search with parameters outside the physical range. Explicit steps of
/// this length are stable for films with rates up to 28,000 1/s. The eccentricity of a faster film
/// is limited in each step, and its state reports the number of such steps.
pub(crate) const SHORTEST_FILM_STEP_S: f64 = 1e-4;

/// Largest rate of a film that the shortest inner step of a prediction (0.1 ms) resolves, 1/s; see
/// [`film_rate_1_s`].
pub const FASTEST_FILM_1_S: f64 = 2.8 / SHORTEST_FILM_STEP_S;

/// Predicts the reading of the instrument (N) at each sample of a record, with inner steps of at
/// most `max_step_s`.
///
/// `sink` receives the index of each sample and its reading. The inner steps are shorter if the law
/// requires it, down to 0.1 ms, and end at every reversal. For a motion that
/// starts or stops between two samples, the record must contain a sample at that instant; otherwise
/// the motion starts or stops at the next sample.
///
/// The function is inlined into its caller, so that a caller compiled for a wider instruction set
/// includes all of it.
#[inline(always)]
pub fn predict<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
    max_step_s: f64,
    sink: impl FnMut(usize, T),
) {
    predict_by(chain, record, max_step_s, Steps::Every, sink);
}

/// Selection of the inner steps between two samples that a chain computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steps {
    /// All inner steps.
    Every,
    /// Only the last inner step before each sample.
    ///
    /// The other steps do not change a reading of a chain without memory ([`Effect::has_memory`],
    /// `jbf_batch::film_path::OnPath`).
    Last,
}

/// Predicts the readings along a record like [`predict`], with all inner steps or only the last one
/// before each sample.
#[inline(always)]
pub fn predict_by<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
    max_step_s: f64,
    made: Steps,
    mut sink: impl FnMut(usize, T),
) {
    let Some(mut from) = record.sample(0) else {
        return;
    };
    let max_step_s = inner_step_s(chain, record, max_step_s);
    let radius_m = chain.rig.radius_m.value();
    let mut state = chain.start(&from.cast());
    sink(0, state.reading_n);
    let mut i = 1;
    while let Some(sample) = record.sample(i) {
        // Step to the reversal first, if any; from there no sign changes. A reversal at the sample
        // itself is reached with the sample, so no step remains after it.
        let zero = reversal(&from, &sample, radius_m)
            .filter(|zero| sample.time_s - zero.time_s >= SHORTEST_STEP_S);
        let to = zero.unwrap_or(sample);
        let dt_s = to.time_s - from.time_s;
        let steps = libm::ceil(dt_s / max_step_s - 1e-9).clamp(1.0, 1e6);
        let first = match (made, zero.is_some()) {
            (Steps::Every, _) => 1,
            (Steps::Last, false) => steps as u32,
            (Steps::Last, true) => steps as u32 + 1,
        };
        between(chain, &mut state, [&from, &to], steps, first);
        if zero.is_none() {
            sink(i, state.reading_n);
            i += 1;
        }
        from = to;
    }
}

/// Fastest rate at which the film of the law responds along a record, 1/s; zero for a law without a
/// film.
///
/// Above [`FASTEST_FILM_1_S`], a prediction limits the eccentricity of the film and does not
/// resolve its dynamics.
pub fn film_rate_1_s<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
) -> f64 {
    1.0 / film_step_s(chain, record)
}

/// Longest inner step of [`predict`] along a record, s: `max_step_s`, or less if the film or an
/// effect requires it.
///
/// The result is infinite (one step per sample) if law and effects have no memory. Predictions of
/// one record with equal inner steps have the same instants.
pub fn inner_step_s<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
    max_step_s: f64,
) -> f64 {
    if !L::HAS_MEMORY && !chain.effects.has_memory() {
        return f64::INFINITY;
    }
    let enough_s = step_s(record) / L::ENOUGH_STEPS;
    let law_s = film_step_s(chain, record)
        .max(SHORTEST_FILM_STEP_S)
        .max(enough_s);
    max_step_s.min(law_s).min(chain.effects.longest_step_s())
}

/// Number of inner steps of [`predict`] along a record, a measure of the computing time.
///
/// The number is accurate to one per sample and reversal.
pub fn inner_steps<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
    max_step_s: f64,
) -> f64 {
    let samples = record.time_s.len() as f64;
    samples * (1.0 + step_s(record) / inner_step_s(chain, record, max_step_s))
}

/// Mean sampling interval of a record, s.
fn step_s(record: &Record<'_>) -> f64 {
    match record.time_s {
        [first, .., last] => (last - first) / (record.time_s.len() - 1) as f64,
        _ => 0.0,
    }
}

/// Longest step that resolves the film along a record, s.
fn film_step_s<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    record: &Record<'_>,
) -> f64 {
    let top = record
        .velocity_m_s
        .iter()
        .fold(0.0_f64, |top, &v| top.max(libm::fabs(v)));
    chain.longest_film_step_s(record, top) / chain.effects.fastest_film()
}

/// Computes the readings (N) of the instrument for a force (N) given at times (s).
///
/// The force is linear between the samples, and only the instrument effects act. `sink` receives
/// the index of each sample and its reading.
pub fn read_force<T: Real>(
    effects: &impl Effect<T>,
    time_s: &[f64],
    force_n: &[f64],
    mut sink: impl FnMut(usize, T),
) {
    let rig = Rig::default();
    let mut states = effects.start(&Motion::at_rest(T::ONE), &rig);
    let longest_s = effects.longest_step_s().min(0.02);
    let mut last: Option<(f64, f64)> = None;
    for (i, (&t, &force)) in time_s.iter().zip(force_n).enumerate() {
        let Some((before_s, before_n)) = last.replace((t, force)) else {
            let mut reading_n = T::of(force);
            effects.first_reading(&mut states, &mut reading_n);
            sink(i, reading_n);
            continue;
        };
        let dt = t - before_s;
        let steps = libm::ceil(dt / longest_s - 1e-9).clamp(1.0, 1e6);
        let mut reading = T::ZERO;
        for k in 0..steps as u32 {
            let at = |share: f64| T::of(before_n + (force - before_n) * share);
            let (begin, end) = (f64::from(k) / steps, f64::from(k + 1) / steps);
            let mut signal = Signal {
                begin_n: at(begin),
                end_n: at(end),
                now_n: at(end),
            };
            let time = T::of(before_s + dt * end - time_s[0]);
            effects.reading(&mut states, &mut signal, time, T::of(dt / steps));
            reading = signal.now_n;
        }
        sink(i, reading);
    }
}

/// Motion at the reversal between two samples; `None` if the speed does not change sign.
///
/// Friction jumps at a reversal, so a step must end there.
#[inline(always)]
fn reversal(from: &Motion<f64>, to: &Motion<f64>, radius_m: f64) -> Option<Motion<f64>> {
    let share = crossing(from.velocity_m_s, to.velocity_m_s)?;
    let mut zero = from.towards(to, share, radius_m);
    zero.velocity_m_s = 0.0;
    Some(zero)
}

/// Advances a chain from one motion to the next in `steps` equal inner steps, starting with step
/// `first`.
///
/// The imposed motion has no derivatives and is converted from plain numbers in each step.
#[inline(always)]
fn between<T: Real, L: Law<T>, E: Effect<T>>(
    chain: &Chain<T, L, E>,
    state: &mut State<T, L::State, E>,
    [from, to]: [&Motion<f64>; 2],
    steps: f64,
    first: u32,
) {
    let inner = T::of((to.time_s - from.time_s) / steps);
    let radius_m = chain.rig.radius_m.value();
    for k in first..=steps as u32 {
        let motion = from.towards(to, f64::from(k) / steps, radius_m);
        chain.step(state, &motion.cast(), inner);
    }
}
