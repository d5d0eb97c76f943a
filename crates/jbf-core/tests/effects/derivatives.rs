//! Tests of derivatives from dual numbers against central differences, for every parameter of the
//! journal law and of every effect.
//!
//! A central difference of step h has the error h^2 F'''/6 and the rounding error divided by h.
//! With h = 2e-5 of the parameter the first is 4e-10 of the slope times a factor of curvature, for
//! which 2e3 is allowed. The second is the rounding of a thousand steps, 1e-12 of the force,
//! divided by h.

use crate::common::motion::Sines;
use crate::common::{company, readings, table_4_2, LOAD_N};
use jbf_core::effect::{Effects, Info, Need, Rig, CATALOGUE};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Chain, Clock, Dual, Motion, Real};

const DT_S: f64 = 0.01;

/// Load of a run, N; it differs from the nominal load if the effect would otherwise have no
/// influence.
fn load_n(info: &Info) -> f64 {
    if info.needs.contains(&Need::Loads) {
        83.5
    } else {
        LOAD_N
    }
}

/// Readings as a function of the four parameters of the law and those of the effect.
fn run<T: Real>(info: &Info, p: &[T], motion: impl Fn(f64) -> Motion<T>) -> Vec<T> {
    let parameters = Parameters {
        f_m: p[0],
        u_tr_m_s: p[1],
        k0: p[2],
        gamma: p[3],
    };
    let law = Journal::new(&Bearing::THESIS, LOAD_N, &parameters, Clock::Journal).expect("valid");
    let mut effects = Effects::NONE;
    effects.set(info.name, &p[4..]).expect("valid");
    for (name, values) in company(info) {
        let lifted: Vec<T> = values.iter().map(|&v| T::of(v)).collect();
        effects.set(name, &lifted).expect("valid");
    }
    let rig = Rig {
        radius_m: T::of(Bearing::THESIS.radius_m),
        count: T::of(4.0),
        force_at_drive: false,
    };
    readings(&Chain { law, effects, rig }, DT_S, 1000, motion)
}

fn start_values(info: &Info, which: usize) -> Vec<f64> {
    let p = table_4_2::<f64>();
    let own = info
        .parameters
        .iter()
        .map(|p| p.starts[which.min(p.starts.len() - 1)]);
    [p.f_m, p.u_tr_m_s, p.k0, p.gamma]
        .into_iter()
        .chain(own)
        .collect()
}

/// Derivatives of the readings with respect to parameter `i`, from dual numbers.
fn carried(info: &Info, p: &[f64], i: usize, sines: &Sines) -> Vec<f64> {
    let lifted: Vec<Dual<1>> = p
        .iter()
        .enumerate()
        .map(|(k, &v)| {
            if k == i {
                Dual::parameter(v, 0)
            } else {
                Dual::of(v)
            }
        })
        .collect();
    run(info, &lifted, |t| sines.under(load_n(info), t))
        .iter()
        .map(|f| f.slope[0])
        .collect()
}

/// Readings with parameter `i` changed by `by`.
fn moved(info: &Info, p: &[f64], i: usize, by: f64, sines: &Sines) -> Vec<f64> {
    let mut q = p.to_vec();
    q[i] += by;
    run(info, &q, |t| sines.under(load_n(info), t))
}

/// Central and one-sided differences of the readings, their step, and the force from which they
/// were computed.
struct Difference {
    /// Differences of second order, for each sample: central, forward and backward.
    ///
    /// A kink within the step (a contact, a breakaway, a sample where the interpolation of a delay
    /// changes) invalidates a difference across it. The derivative is then that of the side of the
    /// present value.
    slopes: Vec<Vec<f64>>,
    step: f64,
    peak_n: f64,
}

impl Difference {
    /// Asserts that derivatives agree with the difference quotients; returns false if the parameter
    /// has no influence.
    fn check(&self, label: &str, carried: &[f64]) -> bool {
        let largest = carried.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
        let nothing = largest == 0.0 && self.slopes.iter().flatten().all(|&s| s == 0.0);
        if nothing {
            return false;
        }
        let bound = 1e-6 * largest + 4e-12 * self.peak_n / self.step;
        // The tolerance for rounding must not be the reason why the test passes.
        assert!(
            bound < 1e-3 * largest,
            "{label}: {bound:e} against slopes of {largest:e}"
        );
        for (i, &slope) in carried.iter().enumerate() {
            let errors = self.slopes.iter().map(|s| (s[i] - slope).abs());
            let error = errors.fold(f64::INFINITY, f64::min);
            let found: Vec<f64> = self.slopes.iter().map(|s| s[i]).collect();
            assert!(
                error < bound,
                "{label}, sample {i}: {slope} {found:?}, {error:e} > {bound:e}"
            );
        }
        true
    }
}

/// One-sided difference quotient of second order, from values at zero, one and two steps.
fn one_sided(at: &[f64], one: &[f64], two: &[f64], step: f64) -> Vec<f64> {
    let slope = |i: usize| (4.0 * one[i] - two[i] - 3.0 * at[i]) / (2.0 * step);
    (0..at.len()).map(slope).collect()
}

fn peak(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |m: f64, f| m.max(f.abs()))
}

#[test]
fn derivatives_of_every_effect_match_differences() {
    for info in CATALOGUE {
        for which in 0..2 {
            let p = start_values(info, which);
            let mut shows = vec![false; p.len()];
            for sines in [
                Sines::one_way(1.0).resting(3.0, 1.0),
                Sines::two_way(1.0).resting(3.0, 1.0),
            ] {
                for i in 0..p.len() {
                    let h = 2e-5 * if p[i] == 0.0 { 1.0 } else { p[i].abs() };
                    let by = |steps: f64| moved(info, &p, i, steps * h, &sines);
                    let at = by(0.0);
                    let (above, below) = (by(1.0), by(-1.0));
                    let both = above.iter().zip(&below);
                    let difference = Difference {
                        slopes: vec![
                            both.map(|(a, b)| (a - b) / (2.0 * h)).collect(),
                            one_sided(&at, &above, &by(2.0), h),
                            one_sided(&at, &below, &by(-2.0), -h),
                        ],
                        step: h,
                        peak_n: peak(&above),
                    };
                    let label = format!("{} parameter {i} of {p:?}", info.name);
                    shows[i] |= difference.check(&label, &carried(info, &p, i, &sines));
                }
            }
            assert!(shows.iter().all(|&s| s), "{}: {shows:?}", info.name);
        }
    }
}

/// At a finite null value, the derivative equals the one-sided difference of second order.
///
/// A score test for a missing effect uses this derivative.
#[test]
fn derivatives_at_a_finite_null_match_one_sided_differences() {
    let mut seen = 0;
    for info in CATALOGUE {
        for (k, parameter) in info.parameters.iter().enumerate() {
            let Some(null) = parameter.null.filter(|n| n.is_finite()) else {
                continue;
            };
            let mut p = start_values(info, 0);
            p[4 + k] = null;
            // At a rest friction jumps, and a vanishing lag follows the jump immediately: no
            // derivative exists at that sample. Only effects that need a rest have one.
            let sines = match info.name {
                "dwell_stiction" => Sines::two_way(1.0).resting(3.0, 1.0),
                _ => Sines::two_way(1.0),
            };
            // A branch is reached where the force has changed by the gap: little after the sample
            // at which it reversed.
            let share = match info.name {
                "sensor_hysteresis" => 5e-6,
                _ => 5e-5,
            };
            let h = share * parameter.starts[0];
            let [at, one, two] = [0.0, h, 2.0 * h].map(|by| moved(info, &p, 4 + k, by, &sines));
            let mut slopes = vec![one_sided(&at, &one, &two, h)];
            if parameter.lower < null {
                // A level of zero cannot decrease further: the derivatives of the two sides differ.
                let [one, two] = [-h, -2.0 * h].map(|by| moved(info, &p, 4 + k, by, &sines));
                slopes.push(one_sided(&at, &one, &two, -h));
            }
            let difference = Difference {
                slopes,
                step: h,
                peak_n: peak(&at),
            };
            assert!(difference.check(info.name, &carried(info, &p, 4 + k, &sines)));
            seen += 1;
        }
    }
    assert!(seen >= 4, "effects with a finite null: {seen}");
}
