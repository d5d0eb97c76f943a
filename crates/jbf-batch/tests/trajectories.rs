//! Tests that trajectories computed in lanes have the bits and the steps of those computed one by
//! one.

use jbf_batch::{follow_side_by_side, Along, Simd};
use jbf_core::driver::{follow, Cost, Excitation, Sample, Sampled, Sine, Start};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Clock};

const K: usize = 4;

fn law(load_n: f64) -> Journal<f64> {
    Journal::new(
        &Bearing::THESIS,
        load_n,
        &Parameters::TABLE_4_2,
        Clock::Journal,
    )
    .expect("valid")
}

fn bits(sample: &Sample<f64>) -> [u64; 3] {
    [sample.coefficient, sample.xy[0], sample.xy[1]].map(f64::to_bits)
}

fn alone<E: Excitation>(
    law: &Journal<f64>,
    excitation: &E,
    times_s: &[f64],
    start: &Start<f64>,
    tolerance: f64,
) -> (Vec<[u64; 3]>, Cost) {
    let mut found = Vec::new();
    let cost = follow(law, excitation, start, times_s, tolerance, |i, sample| {
        assert_eq!(i, found.len());
        found.push(bits(sample));
    });
    (found, cost.expect("valid"))
}

fn same<E: Excitation>(
    law: &Journal<f64>,
    runs: &[(E, Vec<f64>)],
    start: &Start<f64>,
    tolerance: f64,
) {
    for simd in Simd::available() {
        let mut found = vec![Vec::new(); runs.len()];
        let mut each = runs.iter().zip(&mut found);
        let along = [(); K].map(|()| {
            each.next().map(|((excitation, times_s), out)| Along {
                excitation,
                times_s,
                sink: move |i: usize, sample: &Sample<f64>| {
                    assert_eq!(i, out.len());
                    out.push(bits(sample));
                },
            })
        });
        let costs = follow_side_by_side(law, along, start, tolerance, simd).expect("valid");
        for (i, (excitation, times_s)) in runs.iter().enumerate() {
            let (expected, cost) = alone(law, excitation, times_s, start, tolerance);
            assert_eq!(found[i], expected, "run {i} on {}", simd.name());
            assert_eq!(costs[i], cost, "run {i} on {}", simd.name());
        }
    }
}

fn every(step_s: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| step_s * i as f64).collect()
}

#[test]
fn trajectories_of_sines_of_different_lengths_equal_single_ones() {
    let sine = |top, omega, bias| Sine::with_bias(top, omega, bias).expect("valid");
    let runs = [
        (sine(0.127, 0.1, 0.0), every(0.02, 900)),
        (sine(0.127, 2.0, 0.0), every(0.003, 2000)),
        (sine(0.05, 7.0, 0.2), every(0.05, 40)),
        (sine(0.3, 1.0, -0.01), every(0.02, 500)),
    ];
    for tolerance in [1e-3, 1e-7, 1e-10] {
        for load_n in [37.0, 104.0, 800.0] {
            same(&law(load_n), &runs, &Start::default(), tolerance);
        }
    }
    let elsewhere = Start {
        time_s: -2.0,
        eps: Some(0.5),
        phi_rad: 1.0,
    };
    same(&law(104.0), &runs[..3], &elsewhere, 1e-6);
    same(&law(104.0), &runs[..1], &Start::default(), 1e-6);
}

#[test]
fn trajectories_of_records_with_steps_and_rests_equal_single_ones() {
    let time_s = every(0.01, 400);
    let speeds: Vec<Vec<f64>> = (0..4)
        .map(|k| {
            let at = |t: f64| match k {
                0 => 0.1 * (3.0 * t).sin(),
                1 => 0.2 * (1.0 + k as f64) * if t < 2.0 { 1.0 } else { -1.0 },
                2 => 0.0,
                _ => 0.05 * (t - 1.0) * (t - 3.0),
            };
            time_s.iter().map(|&t| at(t)).collect()
        })
        .collect();
    let runs: Vec<_> = speeds
        .iter()
        .map(|v| (Sampled::new(&time_s, v).expect("valid"), every(0.007, 500)))
        .collect();
    same(&law(104.0), &runs, &Start::default(), 1e-7);
}

#[test]
fn decreasing_times_of_one_trajectory_are_refused_by_name() {
    let motion = Sine::new(0.127, 1.0).expect("valid");
    let falling = [1.0, 0.5];
    let along = |times_s| {
        Some(Along {
            excitation: &motion,
            times_s,
            sink: |_: usize, _: &Sample<f64>| {},
        })
    };
    let good = every(0.1, 3);
    let runs = [along(&good), None, along(&falling), None];
    let refused = follow_side_by_side(&law(104.0), runs, &Start::default(), 1e-6, Simd::best());
    assert!(format!("{}", refused.expect_err("falling times")).contains("times_s"));
}
