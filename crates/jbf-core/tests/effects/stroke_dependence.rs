//! Tests of dry friction that varies along the stroke, against Fourier terms over the stroke.

use crate::common::motion::{held, Sines};
use crate::common::{chain_round, newtons, readings};
use core::f64::consts::PI;
use jbf_core::Bearing;

const F_C_N: f64 = 6.0;
const F_V_N_S_M: f64 = 40.0;
const MIDDLE_M: f64 = 0.1;
const HALF_M: f64 = 0.1;

/// Dry friction at the position `x` (m) relative to its mean.
fn share(a: [f64; 6], x: f64) -> f64 {
    let u = ((x - MIDDLE_M) / HALF_M).clamp(-1.0, 1.0);
    let waves = [
        (0.5 * PI * u).sin(),
        (PI * u).cos(),
        (1.5 * PI * u).sin(),
        (2.0 * PI * u).cos(),
        (2.5 * PI * u).sin(),
        (3.0 * PI * u).cos(),
    ];
    let s = a.iter().zip(waves).map(|(a, w)| a * w).sum::<f64>();
    if s < -0.5 {
        -0.25 / s
    } else {
        1.0 + s
    }
}

fn values(a: [f64; 6]) -> [f64; 8] {
    [a[0], a[1], a[2], a[3], a[4], a[5], MIDDLE_M, HALF_M]
}

#[test]
fn dry_level_depends_on_the_position_but_viscous_friction_does_not() {
    // From 0 to 0.254 m: this includes positions beyond the upper end of the stroke.
    let sines = Sines::two_way(1.0);
    for a in [
        [0.3, -0.2, 0.05, 0.1, -0.07, 0.04],
        [-0.1, 0.4, 0.1, -0.1, 0.1, -0.05],
    ] {
        let law = newtons(F_C_N, F_V_N_S_M);
        let chain = chain_round(law, &[("stroke_dependence", &values(a))]);
        let got = readings(&chain, 0.01, 700, |t| sines.at::<f64>(t));
        for (i, f) in got.iter().enumerate().skip(1) {
            let t = 0.01 * i as f64;
            let (v, way) = (0.127 * t.sin(), 0.127 * (1.0 - t.cos()));
            let expected = F_C_N * share(a, way) * v.signum() + F_V_N_S_M * v;
            assert!((f - expected).abs() < 1e-9, "{a:?} {i}: {f} {expected}");
        }
    }
}

/// Friction level that holds a drive at rest at the position `x` (m), N.
fn level_n(a: [f64; 6], x: f64) -> f64 {
    let chain = chain_round(newtons(F_C_N, 0.0), &[("stroke_dependence", &values(a))]);
    let state = chain.start(&held::<f64>(x / Bearing::THESIS.radius_m, 0.0));
    chain.reaction_n(&state).jump
}

/// The terms have zero mean and are orthogonal to each other over the stroke.
#[test]
fn terms_have_zero_mean_and_are_orthogonal() {
    let n = 2000;
    let unit = |k: usize| core::array::from_fn(|i| if i == k { 0.5 } else { 0.0 });
    let wave = |k: usize, i: usize| {
        let x = MIDDLE_M + HALF_M * ((2 * i + 1) as f64 / n as f64 - 1.0);
        level_n(unit(k), x) / F_C_N - 1.0
    };
    for k in 0..6 {
        let mean = (0..n).map(|i| wave(k, i)).sum::<f64>() / n as f64;
        assert!(mean.abs() < 1e-9, "{k}: {mean}");
        for j in 0..k {
            let both = (0..n).map(|i| wave(k, i) * wave(j, i)).sum::<f64>() / n as f64;
            assert!(both.abs() < 1e-9, "{j} {k}: {both}");
        }
    }
}

/// Dry friction and its slope are continuous at the ends of the stroke.
#[test]
fn level_and_slope_are_continuous_at_the_ends_of_the_stroke() {
    let a = [0.3, -0.2, 0.05, 0.1, -0.07, 0.04];
    let h = 1e-6;
    for end in [MIDDLE_M - HALF_M, MIDDLE_M + HALF_M] {
        let slope = |x: f64| (level_n(a, x + h) - level_n(a, x - h)) / (2.0 * h);
        // The slope falls linearly to zero over the distance, some 2 N/m^2 times 1e3.
        assert!(slope(end).abs() < 0.02, "{}", slope(end));
        assert!((level_n(a, end - h) - level_n(a, end + h)).abs() < 1e-6);
        assert!(slope(end + 0.3 * (end - MIDDLE_M)).abs() < 1e-9);
    }
    assert!((level_n(a, MIDDLE_M + h) - level_n(a, MIDDLE_M - h)).abs() > 1e-5);
}

/// A relative change below -1/2 leaves a positive level with a continuous slope.
#[test]
fn level_is_positive_where_the_terms_would_make_it_negative() {
    let level = |s: f64| level_n([0.0, s, 0.0, 0.0, 0.0, 0.0], MIDDLE_M) / F_C_N;
    for (s, expected) in [
        (1.5, 2.5),
        (-0.4, 0.6),
        (-0.5, 0.5),
        (-1.0, 0.25),
        (-2.0, 0.125),
    ] {
        assert!((level(s) - expected).abs() < 1e-12, "{s}: {}", level(s));
    }
    let slope = |s: f64| (level(s + 1e-6) - level(s - 1e-6)) / 2e-6;
    assert!((slope(-0.499) - 1.0).abs() < 1e-6);
    assert!((slope(-0.501) - 1.0).abs() < 5e-3);
    assert!(level_n([0.0, 2.0, 0.0, 0.0, 0.0, 0.0], 0.0) > 0.1 * F_C_N);
}
