//! Tests of the elasto-plastic law: its closed form, and the absence of drift below breakaway.

use super::support::{along, axis, gap, moving, sine};
use jbf_core::effect::Effects;
use jbf_core::law::elasto_plastic::ElastoPlastic;
use jbf_core::law::Named;
use jbf_core::{Clock, Motion};

const F_C: f64 = 8.0;
const SIGMA: f64 = 2e5;
const SPEED: f64 = 0.01;

/// After a reversal, the force is linear in the displacement up to breakaway and then exponential,
/// whatever the time step.
#[test]
fn friction_after_a_reversal_follows_its_closed_form() {
    for share in [0.0, 0.3, 0.7, 0.999] {
        for steps in [7, 50, 1000] {
            let dt = 0.05 / f64::from(steps);
            let at = |t: f64| moving(t, if t < 1e-12 { SPEED } else { -SPEED }, 0.0);
            let force = along::<f64>("elasto_plastic", &[F_C, SIGMA, share, 0.0], dt, steps, at);
            assert_eq!(force[0], F_C);
            // The first step reverses in the middle: a quarter of it in each direction, and the
            // first quarter slides.
            for (i, f) in force.iter().enumerate().skip(1) {
                let way = SPEED * dt * (i as f64 - 1.0) + 0.25 * SPEED * dt;
                let elastic = (1.0 + share) * F_C / SIGMA;
                let expected = if way < elastic {
                    F_C - SIGMA * way
                } else {
                    let beyond = SIGMA * (way - elastic) / (F_C * (1.0 - share));
                    -F_C * (1.0 - (1.0 - share) * (-beyond).exp())
                };
                assert!(
                    (f - expected).abs() < 1e-9 * F_C,
                    "b {share}, {i}: {f} {expected}"
                );
            }
        }
    }
}

/// Change of the force after many small oscillations of the position, N.
///
/// The position first moves until the force has the given level, and each oscillation returns to
/// this position.
fn drift(name: &str, values: &[f64], level: f64) -> f64 {
    let (reach, swing) = (level * F_C / SIGMA, 0.1 * F_C / SIGMA);
    let omega = std::f64::consts::TAU;
    let motion = |t: f64| -> Motion<f64> {
        if t < 1.0 {
            // As much as the swing has, so that nothing jumps.
            let speed = 6.0 * t * (1.0 - t);
            moving(t, reach * speed, reach * t * t * (3.0 - 2.0 * t))
        } else {
            let phase = omega * (t - 1.0);
            moving(
                t,
                -swing * omega * phase.sin(),
                reach - swing * (1.0 - phase.cos()),
            )
        }
    };
    let force = along::<f64>(name, values, 1e-3, 101_000, motion);
    (force[101_000] - force[1000]).abs()
}

#[test]
fn swings_below_the_breakaway_cause_no_drift() {
    let own = drift("elasto_plastic", &[F_C, SIGMA, 0.7, 0.0], 0.6);
    assert!(own < 1e-5 * F_C, "{own}");
    for (name, values) in [
        ("dahl", [F_C, SIGMA, 1.0, 0.0].as_slice()),
        ("lugre", &[F_C, F_C, 0.01, SIGMA, 0.0, 0.1, 0.0]),
    ] {
        let other = drift(name, values, 0.6);
        assert!(other > 0.2 * F_C, "{name}: {other}");
    }
}

/// Oscillations beyond breakaway cause drift, a known limitation of the model.
#[test]
fn swings_beyond_the_breakaway_cause_drift() {
    let own = drift("elasto_plastic", &[F_C, SIGMA, 0.3, 0.0], 0.9);
    assert!(own > 0.01 * F_C, "{own}");
}

/// With a breakaway force close to F_c, the law is a spring with a slider; with a large stiffness,
/// it is Coulomb's law.
#[test]
fn stiff_law_equals_coulombs_law_and_breakaway_near_the_level_a_spring_with_slider() {
    let (dt, steps) = (2.03e-3, 3000);
    let run =
        |name: &str, values: &[f64], a: f64| along::<f64>(name, values, dt, steps, sine(a, 3.0));
    let slider = run("elasto_plastic", &[F_C, 1e5, 0.999, 30.0], 2e-4);
    let seven = run(
        "seven_parameter",
        &[1e5, F_C, 30.0, 1e-6, 0.01, 0.0, 1.0],
        2e-4,
    );
    assert!(gap(&slider, &seven) < 0.04, "{}", gap(&slider, &seven));
    let stiff = run("elasto_plastic", &[F_C, 1e12, 0.7, 30.0], 0.02);
    let rigid = run("coulomb", &[F_C, 9.0, 30.0], 0.02);
    assert!(gap(&stiff, &rigid) < 1e-9, "{}", gap(&stiff, &rigid));
}

/// Friction under a varying load follows `z' = v (1 - alpha sgn(v) z/z_ss)`, integrated in steps a
/// thousand times shorter.
///
/// The effect `dry_load_dependence` makes the friction level depend on the load.
#[test]
fn friction_under_a_varying_load_follows_its_differential_equation() {
    let (share, mu) = (0.6, 0.4);
    let law = ElastoPlastic::build(None, None, &[F_C, SIGMA, share, 0.0], Clock::Journal);
    let mut effects = Effects::NONE;
    effects.set("dry_load_dependence", &[mu]).expect("valid");
    let chain = axis(law.expect("valid"), effects);
    let place = |t: f64| 1.2e-4 * (2.0 * t).sin();
    let speed = |t: f64| 2.4e-4 * (2.0 * t).cos();
    let load = |t: f64| 10.0 + 6.0 * (0.9 * t).sin();
    let at = |t: f64| {
        let mut motion = moving(t, speed(t), place(t));
        motion.load_n = load(t);
        motion
    };
    let (dt, fine) = (1e-3, 1000);
    let mut state = chain.start(&at(0.0));
    let mut force = F_C + mu * load(0.0);
    let mut worst: f64 = 0.0;
    for i in 0..6000 {
        let t = dt * f64::from(i);
        for k in 0..fine {
            let h = dt / f64::from(fine);
            let s = t + h * (f64::from(k) + 0.5);
            let (v, level) = (speed(s), F_C + mu * load(s));
            let y = force * v.signum() / level;
            let alpha = if y <= share {
                0.0
            } else {
                (1.0 - share / y) / (1.0 - share)
            };
            force += SIGMA * v * (1.0 - alpha * y) * h;
        }
        let reading = chain.step(&mut state, &at(t + dt), dt);
        worst = worst.max((reading - force).abs());
    }
    assert!(worst < 2e-3 * F_C, "{worst}");
}
