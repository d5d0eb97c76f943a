//! Tests that the results of a batch are identical bit for bit for every instruction set and number
//! of threads.
//!
//! They also equal the results of `jbf_core` for one law after the other, even if steps are so
//! coarse that the eccentricity is limited.

use jbf_batch::{Batch, Films, Float, Method, Simd, Speeds};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::Law;
use jbf_core::stepper::{Euler, Rk4};
use jbf_core::{Bearing, Clock};

const SAMPLES: usize = 300;

/// Parameter sets over the range of the tables in Cohn (1998); their number is not a multiple of
/// the block size.
fn laws<F: Float>(sets: usize) -> Vec<Journal<F>> {
    let share = |i: usize, k: usize| 0.8 + 0.4 * ((i * 37 + k * 101) % 97) as f64 / 97.0;
    (0..sets)
        .map(|i| {
            let parameters = Parameters {
                f_m: F::of(0.26 * share(i, 0)),
                u_tr_m_s: F::of(0.06 * share(i, 1)),
                k0: F::of(7.5e5 * share(i, 2)),
                gamma: F::of(33.0 * share(i, 3)),
            };
            let load_n = 104.0 * share(i, 4);
            Journal::new(&Bearing::THESIS, load_n, &parameters, Clock::Journal).expect("valid")
        })
        .collect()
}

/// Surface speed at a sample, m/s: a motion in both directions with rests, and with a phase that
/// depends on `set`.
fn speed<F: Float>(sample: usize, set: usize) -> F {
    let wave = (0.03 * sample as f64 + set as f64).sin();
    F::of(if wave.abs() < 0.1 { 0.0 } else { 0.127 * wave })
}

/// Computes the friction of one law after the other with `jbf_core`.
fn alone<F: Float>(batch: &Batch<F>, dt_s: F, u: impl Fn(usize, usize) -> F) -> (Vec<F>, Films<F>) {
    let mut films = batch.start();
    let laws = laws::<F>(films.0.len());
    let mut out = vec![F::ZERO; SAMPLES * laws.len()];
    for (set, (law, film)) in laws.iter().zip(&mut films.0).enumerate() {
        for i in 0..SAMPLES {
            let from = u(i, set);
            out[i * laws.len() + set] = law.friction(film, from).along(from.sign());
            if i + 1 < SAMPLES {
                let to = u(i + 1, set);
                let ends = [from.abs(), ((from + to) * F::of(0.5)).abs(), to.abs()];
                match batch.method {
                    Method::Euler => law.advance_with(&Euler, film, ends, F::ONE, dt_s),
                    Method::Rk4 => law.advance_with(&Rk4, film, ends, F::ONE, dt_s),
                }
            }
        }
    }
    (out, films)
}

fn bits<F: Float>(values: &[F]) -> Vec<u64> {
    values.iter().map(|v| v.value().to_bits()).collect()
}

fn agree<F: Float>(sets: usize, method: Method, dt_s: f64) -> u32 {
    let dt_s = F::of(dt_s);
    let common: Vec<F> = (0..SAMPLES).map(|i| speed(i, 0)).collect();
    let each: Vec<F> = (0..SAMPLES * sets)
        .map(|k| speed(k / sets, k % sets))
        .collect();
    let mut held = 0;
    for simd in Simd::available() {
        for threads in [1, 2, 3] {
            let mut batch = Batch::new(laws::<F>(sets), method);
            batch.simd = simd;
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let cases = [
                    (
                        Speeds::Common(&common),
                        alone(&batch, dt_s, |i, _| speed(i, 0)),
                    ),
                    (
                        Speeds::Each { rows: &each, sets },
                        alone(&batch, dt_s, speed),
                    ),
                ];
                for (speeds, (expected, ends)) in &cases {
                    let mut films = batch.start();
                    let mut out = vec![F::ZERO; SAMPLES * sets];
                    batch.friction(&mut films, speeds, dt_s, &mut out);
                    assert_eq!(bits(&out), bits(expected), "{} {threads}", simd.name());
                    assert!(films.0 == ends.0, "{} {threads}", simd.name());
                    held += films.0.iter().map(|f| f.clamped).sum::<u32>();
                    let data = vec![F::of(0.1); SAMPLES];
                    let squares = batch.squares(&mut batch.start(), speeds, dt_s, &data);
                    assert_eq!(squares.len(), sets);
                    for (set, sum) in squares.iter().enumerate() {
                        let mut expect = F::ZERO;
                        for i in 0..SAMPLES {
                            let r = expected[i * sets + set] - data[i];
                            expect += r * r;
                        }
                        assert_eq!(sum.value().to_bits(), expect.value().to_bits());
                    }
                }
            });
        }
    }
    held
}

#[test]
fn batch_equals_single_laws_bit_for_bit_in_double_precision() {
    for sets in [1, 31, 32, 75] {
        assert_eq!(agree::<f64>(sets, Method::Euler, 0.002), 0);
        assert_eq!(agree::<f64>(sets, Method::Rk4, 0.002), 0);
    }
}

#[test]
fn batch_equals_single_laws_bit_for_bit_in_single_precision() {
    for sets in [1, 75] {
        agree::<f32>(sets, Method::Euler, 0.002);
        agree::<f32>(sets, Method::Rk4, 0.002);
    }
}

/// The eccentricity of a film that leaves its bearing in a coarse step is limited as in `jbf_core`.
#[test]
fn eccentricity_is_limited_as_in_the_core_if_steps_are_too_coarse() {
    assert!(agree::<f64>(40, Method::Euler, 0.3) > 0);
    assert!(agree::<f64>(40, Method::Rk4, 0.8) > 0);
    assert!(agree::<f32>(40, Method::Euler, 0.3) > 0);
}

#[test]
fn batch_without_laws_or_samples_returns_nothing() {
    let none = Batch::<f64>::new(Vec::new(), Method::Euler);
    none.friction(
        &mut none.start(),
        &Speeds::Common(&[0.1, 0.2]),
        0.002,
        &mut [],
    );
    assert!(none
        .squares(&mut none.start(), &Speeds::Common(&[]), 0.002, &[])
        .is_empty());
    let some = Batch::<f64>::new(laws(3), Method::Euler);
    some.friction(&mut some.start(), &Speeds::Common(&[]), 0.002, &mut []);
}
