//! Tests of the Maxwell slip law: the virgin curve, Masing's rules, and the memory of reversals.

use super::support::{along, axis, gap, moving, sine};
use jbf_core::effect::Effects;
use jbf_core::law::maxwell_slip::MaxwellSlip;
use jbf_core::law::Named;
use jbf_core::{Clock, Motion};

const F_C: f64 = 6.0;
const SIGMA: f64 = 2e5;

fn values(exponent: f64) -> [f64; 4] {
    [F_C, SIGMA, exponent, 0.0]
}

/// Forces (N) at a sequence of positions (m), starting at rest without deflection, with a smooth
/// stroke to each position.
fn at_places<T: jbf_core::Real>(name: &str, values: &[T], places: &[f64]) -> Vec<T> {
    const STEPS: u32 = 200;
    let mut whole = vec![0.0];
    whole.extend_from_slice(places);
    let turns = whole.clone();
    let motion = move |t: f64| -> Motion<T> {
        let leg = (t as usize).min(turns.len() - 2);
        let share = t - leg as f64;
        let way = turns[leg + 1] - turns[leg];
        // Each stroke starts and ends at rest, with constant acceleration and deceleration: steps
        // with linear speed reproduce the distance exactly.
        let (speed, done) = if share <= 0.5 {
            (4.0 * share, 2.0 * share * share)
        } else {
            (
                4.0 * (1.0 - share),
                1.0 - 2.0 * (1.0 - share) * (1.0 - share),
            )
        };
        moving(t, way * speed, turns[leg] + way * done)
    };
    let steps = STEPS * places.len() as u32;
    let force = along::<T>(name, values, 1.0 / f64::from(STEPS), steps, motion);
    (1..=places.len())
        .map(|k| force[k * STEPS as usize])
        .collect()
}

/// Virgin curve of Dahl's law, N.
fn virgin(exponent: f64, place_m: f64) -> f64 {
    let s = SIGMA * place_m / F_C;
    let m = 1.0 - exponent;
    if m.abs() < 1e-9 {
        return F_C * (1.0 - (-s).exp());
    }
    F_C * (1.0 - (1.0 - m * s).max(0.0).powf(1.0 / m))
}

/// The virgin curve of the elements is above that of Dahl's law, by at most the error due to the
/// number of elements.
#[test]
fn virgin_curve_agrees_with_dahls_within_the_error_of_sixteen_elements() {
    let leaves = [
        (0.03, 0.011),
        (0.1, 0.008),
        (1.0 / 3.0, 0.0035),
        (0.5, 0.0025),
        (1.0, 0.006),
    ];
    for (exponent, share) in leaves {
        for k in 1..60 {
            let place = f64::from(k) * 0.1 * F_C / SIGMA;
            let force = at_places("maxwell_slip", &values(exponent), &[place])[0];
            let over = (force - virgin(exponent, place)) / F_C;
            assert!(
                (-1e-9..share).contains(&over),
                "i {exponent}, {place} m: {over}"
            );
        }
    }
}

/// At a reversal every element sticks, so the slope is sigma_0 for every shape.
#[test]
fn stiffness_at_a_reversal_is_sigma_0() {
    for exponent in [0.01, 0.3, 1.0 - 1e-4, 1.0, 1.0 + 1e-4, 2.0] {
        let small = 1e-3 * F_C / SIGMA;
        let [bent, back] = at_places("maxwell_slip", &values(exponent), &[1e-2, 1e-2 - small])[..]
        else {
            panic!("two places");
        };
        assert!((bent - F_C).abs() < 1e-3 * F_C, "i {exponent}: {bent}");
        let slope = (bent - back) / small;
        assert!((slope / SIGMA - 1.0).abs() < 1e-9, "i {exponent}: {slope}");
    }
}

/// After a reversal at x_0, F_0, the force follows Masing's rule `F_0 - 2 V((x_0 - x)/2)`, with the
/// virgin curve V.
#[test]
fn branch_after_a_reversal_follows_masings_rule() {
    for exponent in [0.1, 0.5, 1.0] {
        for turn in [0.3, 0.9, 4.0] {
            let turn = turn * F_C / SIGMA;
            for part in [0.1, 0.5, 1.3, 2.0] {
                let law = values(exponent);
                let forces = at_places("maxwell_slip", &law, &[turn, turn * (1.0 - part)]);
                let half = at_places("maxwell_slip", &law, &[0.5 * part * turn])[0];
                let masing = forces[0] - 2.0 * half;
                assert!(
                    (forces[1] - masing).abs() < 1e-9 * F_C,
                    "{exponent} {turn} {part}"
                );
            }
        }
    }
}

/// An inner loop closes at the point where it began, also within another loop.
///
/// The force then continues as without the loops. Dahl's law drifts.
#[test]
fn inner_loops_close_and_leave_no_memory() {
    let unit = F_C / SIGMA;
    let places = |of: &[f64]| of.iter().map(|x| x * unit).collect::<Vec<_>>();
    let with = places(&[1.5, -0.2, 0.8, 0.3, 0.6, 0.3, 0.8, -0.2, -0.9]);
    let plain = places(&[1.5, -0.9]);
    let within = |law: &str, values: &[f64]| {
        let f = at_places(law, values, &with);
        let end = *at_places(law, values, &plain).last().expect("two");
        [f[5] - f[3], f[6] - f[2], f[7] - f[1], f[8] - end].map(f64::abs)
    };
    for exponent in [0.1, 0.5, 1.0] {
        let open = within("maxwell_slip", &values(exponent));
        assert!(
            open.iter().all(|x| *x < 1e-9 * F_C),
            "i {exponent}: {open:?}"
        );
    }
    let dahl = within("dahl", &[F_C, SIGMA, 1.0, 0.0]);
    assert!(dahl.iter().all(|x| *x > 1e-3 * F_C), "{dahl:?}");
}

/// Inner loops also close in single precision, although rounding errors of the position accumulate
/// over many reversals.
#[test]
fn inner_loops_close_in_single_precision_after_50_reversals() {
    let unit = F_C / SIGMA;
    let law = values(0.5).map(|x| x as f32);
    let mut places = vec![1.5 * unit];
    for _ in 0..50 {
        places.extend([-0.2 * unit, 0.8 * unit]);
    }
    let forces = at_places("maxwell_slip", &law, &places);
    let open = (forces[forces.len() - 1] - forces[2]).abs();
    assert!(f64::from(open) < 1e-3 * F_C, "{open}");
}

/// A load that oscillates below F_c causes no ratchetting: each cycle equals the previous one.
#[test]
fn load_cycles_below_f_c_cause_no_ratchetting() {
    let unit = F_C / SIGMA;
    let mut places = vec![1.2 * unit];
    for _ in 0..100 {
        places.extend([0.9 * unit, 1.2 * unit]);
    }
    let forces = at_places("maxwell_slip", &values(1.0), &places);
    for top in forces.iter().step_by(2) {
        assert!((top - forces[0]).abs() < 1e-9 * F_C, "{top} {}", forces[0]);
    }
}

/// With a large stiffness the law is Coulomb's; with a small exponent it is the elasto-plastic law
/// whose breakaway force is F_c.
#[test]
fn stiff_law_equals_coulombs_law_and_small_exponent_the_elasto_plastic_law() {
    let (dt, steps) = (2.03e-3, 3000);
    let run =
        |name: &str, values: &[f64], a: f64| along::<f64>(name, values, dt, steps, sine(a, 3.0));
    let stiff = run("maxwell_slip", &[8.0, 1e12, 0.5, 30.0], 0.02);
    let rigid = run("coulomb", &[8.0, 12.0, 30.0], 0.02);
    assert!(gap(&stiff, &rigid) < 1e-9, "{}", gap(&stiff, &rigid));
    let level = run("maxwell_slip", &[8.0, 1e5, 0.01, 30.0], 2e-4);
    let elastic = run("elasto_plastic", &[8.0, 1e5, 0.999, 30.0], 2e-4);
    assert!(
        gap(&level, &elastic) < 0.02 * 8.0,
        "{}",
        gap(&level, &elastic)
    );
}

/// With the effect `stribeck_excess` the law equals the generalised Maxwell slip law (GMS).
///
/// The reference has explicit elements, each sticking or at its fraction of the present friction
/// level, in steps a hundred times shorter.
#[test]
fn law_with_stribeck_excess_equals_generalised_maxwell_slip() {
    let (exponent, a, v_s) = (1.0, 3.0, 2e-4);
    let law = MaxwellSlip::build(None, None, &values(exponent), Clock::Journal).expect("valid");
    let mut effects = Effects::NONE;
    effects
        .set("stribeck_excess", &[a, v_s, 2.0])
        .expect("valid");
    let chain = axis(law, effects);
    let place = |t: f64| 1.2e-4 * (2.0 * t).sin() + 4e-5 * (7.0 * t).sin();
    let speed = |t: f64| 2.4e-4 * (2.0 * t).cos() + 2.8e-4 * (7.0 * t).cos();
    let level = |v: f64| F_C + a * (-(v / v_s) * (v / v_s)).exp();
    let at = |t: f64| moving::<f64>(t, speed(t), place(t));
    // In an exponential curve the springs up to the share u carry u (1 - ln u).
    let carried = |j: f64| {
        let u = (j / 16.0).powf(1.5);
        if u > 0.0 {
            (u, u * (1.0 - u.ln()))
        } else {
            (0.0, 0.0)
        }
    };
    let elements: Vec<(f64, f64)> = (0..16)
        .map(|j| (carried(f64::from(j)), carried(f64::from(j + 1))))
        .map(|(low, high)| (SIGMA * (high.0 - low.0), high.1 - low.1))
        .collect();
    let mut forces: Vec<f64> = elements.iter().map(|e| e.1 * level(speed(0.0))).collect();
    let error = |dt: f64, forces: &mut Vec<f64>| {
        let mut state = chain.start(&at(0.0));
        let mut worst: f64 = 0.0;
        for i in 0..(8.0 / dt) as u32 {
            let t = dt * f64::from(i);
            for k in 1..=100 {
                let s = t + dt * f64::from(k) / 100.0;
                let way = place(s) - place(s - dt / 100.0);
                for (force, (stiffness, share)) in forces.iter_mut().zip(&elements) {
                    let most = share * level(speed(s));
                    *force = (*force + stiffness * way).clamp(-most, most);
                }
            }
            let reading = chain.step(&mut state, &at(t + dt), dt);
            worst = worst.max((reading - forces.iter().sum::<f64>()).abs());
        }
        worst
    };
    let begin = forces.clone();
    let coarse = error(4e-3, &mut forces);
    forces.clone_from(&begin);
    let fine = error(1e-3, &mut forces);
    assert!(fine < 5e-3 * F_C && fine < 0.5 * coarse, "{coarse} {fine}");
}

/// Friction follows the continuous distribution of elements that the law approximates.
///
/// The reference is Dahl's virgin curve with Masing's rules and a stack of reversals, along a
/// motion that reverses at many amplitudes.
#[test]
fn friction_follows_masings_rules_for_a_stack_of_reversals() {
    let exponent = 0.5;
    let at =
        |t: f64| 4e-5 * ((1.3 * t).sin() + 0.7 * (3.1 * t + 1.0).sin()) * (0.3 * t).sin().powi(2);
    // A run that begins at rest begins without deflection.
    let slope = |t: f64| {
        if t > 0.0 {
            (at(t + 1e-6) - at(t - 1e-6)) / 2e-6
        } else {
            0.0
        }
    };
    let (dt, steps) = (1e-3, 30_000);
    let law = values(exponent);
    let force = along::<f64>("maxwell_slip", &law, dt, steps, |t| {
        moving(t, slope(t), at(t))
    });
    // Reversals not yet wiped out: position and force.
    let mut turns: Vec<(f64, f64)> = vec![];
    let (mut place, mut now, mut last): (f64, f64, f64) = (at(0.0), 0.0, 0.0);
    let origin = place;
    let mut worst: f64 = 0.0;
    for (i, f) in force.iter().enumerate().skip(1) {
        let next = at(dt * i as f64);
        let way = (next - place).signum();
        if last != 0.0 && way != last {
            turns.push((place, now));
        }
        // A branch that passes the reversal before its own closes the loop: both are removed.
        while turns.len() > 1 && way * (next - turns[turns.len() - 2].0) > 0.0 {
            turns.truncate(turns.len() - 2);
        }
        // So does the first branch at the mirror image of its reversal.
        if turns.len() == 1 && (next - origin).abs() > (turns[0].0 - origin).abs() {
            turns.clear();
        }
        now = match turns.last() {
            None => way.signum() * virgin(exponent, (next - origin).abs()),
            Some((x, f)) => f + way * 2.0 * virgin(exponent, 0.5 * (next - x).abs()),
        };
        (place, last) = (next, way);
        worst = worst.max((f - now).abs());
    }
    // Difference between the elements and a virgin curve, from reversal to reversal.
    assert!(worst < 0.01 * F_C, "{worst}");
}

#[test]
fn elements_add_up_to_the_level_and_the_stiffness_at_a_reversal() {
    let law = MaxwellSlip::<f64>::build(None, None, &values(0.5), Clock::Journal).unwrap();
    let (mut stiffness, mut level) = (0.0, 0.0);
    for [k, most] in law.elements() {
        assert!(k > 0.0 && most > 0.0);
        stiffness += k;
        level += most;
    }
    assert!((stiffness / SIGMA - 1.0).abs() < 1e-12);
    assert!((level / F_C - 1.0).abs() < 1e-12);
}
