//! Tests of each law against a closed form.

use super::support::{along, axis, in_newtons, moving, sine, starts};
use jbf_core::effect::Effects;
use jbf_core::law::coulomb::Coulomb;
use jbf_core::law::{steady_n, Named};
use jbf_core::{Clock, Motion};

/// Friction after a long slide at constant speed equals the steady friction, for every law and in
/// both directions.
#[test]
fn friction_after_a_long_slide_is_on_the_steady_curve() {
    for law in in_newtons() {
        let values = starts(law);
        for v in [1e-4, 3e-3, 0.02, 0.5, -0.02] {
            let mut expected = [0.0];
            steady_n(
                law.name,
                None,
                None,
                &values,
                Clock::Journal,
                &[v],
                &mut expected,
            )
            .expect("valid");
            // From rest, so that bristles deflect first: a millimetre is a hundred times their
            // deflection.
            let steps = 2000;
            let dt = (0.05 / v.abs()).max(1.0) / f64::from(steps);
            let at = |t: f64| moving(t, if t > 0.0 { v } else { 0.0 }, v * t);
            let end = *along::<f64>(law.name, &values, dt, steps, at)
                .last()
                .expect("steps");
            let error = (end - expected[0]).abs();
            assert!(
                error < 1e-9 * end.abs(),
                "{} {v}: {end} {expected:?}",
                law.name
            );
        }
    }
}

#[test]
fn steady_stribeck_friction_equals_its_formula() {
    let (fc, fs, vs, fv): (f64, f64, f64, f64) = (7.0, 11.0, 0.02, 30.0);
    for delta in [0.5, 1.0, 2.0] {
        for v in [1e-5, 0.004, 0.02, 0.3] {
            let mut f = [0.0];
            let values = [fc, fs, vs, delta, fv];
            steady_n(
                "stribeck",
                None,
                None,
                &values,
                Clock::Journal,
                &[-v],
                &mut f,
            )
            .expect("valid");
            let formula = fc + (fs - fc) * (-(v / vs).powf(delta)).exp() + fv * v;
            assert!((f[0] + formula).abs() < 1e-13 * formula);
        }
    }
}

/// The force of Dahl's law after a reversal follows its closed form in the sliding distance, for
/// every speed and step.
#[test]
fn dahl_friction_after_a_reversal_follows_its_closed_form() {
    let (fc, sigma) = (8.0, 2e5);
    let speed = 0.01;
    for exponent in [0.3, 0.999, 1.0, 1.0004, 1.5, 3.0] {
        let values = [fc, sigma, exponent, 0.0];
        for steps in [7, 50, 1000] {
            let dt = 0.05 / f64::from(steps);
            let at = |t: f64| moving(t, if t < 1e-12 { speed } else { -speed }, 0.0);
            let force = along::<f64>("dahl", &values, dt, steps, at);
            assert_eq!(force[0], fc);
            // The first step reverses in the middle, so its net distance is zero. The others go
            // backward.
            for (i, f) in force.iter().enumerate().skip(2) {
                let s = speed * dt * (i as f64 - 1.0) + 0.25 * speed * dt;
                let k = sigma / fc;
                let u0: f64 = 2.0;
                let u = if exponent == 1.0 {
                    u0 * (-k * s).exp()
                } else {
                    let m = 1.0 - exponent;
                    let base: f64 = 1.0 - m * k * s * u0.powf(-m);
                    if base > 0.0 {
                        u0 * base.powf(1.0 / m)
                    } else {
                        0.0
                    }
                };
                let expected = -fc * (1.0 - u);
                assert!(
                    (f - expected).abs() < 1e-9 * fc,
                    "i {exponent}, {steps} steps, sample {i}: {f} {expected}"
                );
            }
        }
    }
}

/// The force of the LuGre law at constant speed from rest is `sigma_0 z = level (1 - exp(-sigma_0
/// s/level))`, plus damping.
#[test]
fn lugre_friction_from_rest_follows_its_closed_form() {
    let (fc, fs, vs, s0, s1, vd, fv): (f64, f64, f64, f64, f64, f64, f64) =
        (6.0, 9.0, 0.01, 1e5, 200.0, 0.05, 12.0);
    let values = [fc, fs, vs, s0, s1, vd, fv];
    let v = 0.004;
    let level = fc + (fs - fc) * (-(v / vs) * (v / vs)).exp();
    let damping = s1 * (-(v / vd) * (v / vd)).exp();
    // At constant speed from the first sample on the bristle is deflected; a reversal relaxes it.
    let dt = 1e-3;
    let at = |t: f64| moving::<f64>(t, if t < 1e-12 { 0.0 } else { v }, 0.0);
    let force = along::<f64>("lugre", &values, dt, 400, at);
    // After the first step, in which the speed rises from zero, the bristle starts from its state.
    let first = (force[1] - fv * v - damping * v) / (1.0 - damping * v / level);
    for (i, f) in force.iter().enumerate().skip(1) {
        let way = v * dt * (i as f64 - 1.0);
        let y = level + (first - level) * (-s0 * way / level).exp();
        let expected = y + damping * (v - v * y / level) + fv * v;
        assert!((f - expected).abs() < 1e-10, "{i}: {f} {expected}");
    }
}

/// Under a rigid drive, a lagging load cell reads the response to a step of F_c after a rest,
/// because breakaway from F_s takes no time.
#[test]
fn reading_of_a_lagging_cell_after_a_rest_is_the_response_to_a_step_of_f_c() {
    let law = <Coulomb<f64> as Named<f64>>::build(None, None, &[6.0, 9.0, 0.0], Clock::Journal)
        .expect("valid");
    let (tau, dt, rest) = (0.03, 0.01, 10);
    let mut effects = Effects::NONE;
    effects.set("sensor_lag", &[tau]).expect("valid");
    let chain = axis(law, effects);
    let at = |i: i32| {
        let (t, speed) = (dt * f64::from(i), if i <= rest { 0.0 } else { 0.1 });
        moving(t, speed, 0.1 * dt * f64::from((i - rest).max(0)))
    };
    let mut state = chain.start(&at(0));
    for i in 1..40 {
        let reading = chain.step(&mut state, &at(i), dt);
        let since = dt * f64::from((i - rest).max(0));
        let expected = 6.0 * (1.0 - (-since / tau).exp());
        assert!(
            (reading - expected).abs() < 1e-12,
            "{i}: {reading} {expected}"
        );
    }
}

/// Static friction holds a journal with a compliant drive up to F_s; then it slides with F_c.
#[test]
fn coulomb_friction_behind_a_compliant_drive_sticks_to_f_s_and_slides_at_f_c() {
    let law = <Coulomb<f64> as Named<f64>>::build(None, None, &[6.0, 9.0, 0.0], Clock::Journal)
        .expect("valid");
    let mut effects = Effects::NONE;
    effects
        .set("drive_compliance", &[1000.0, 5.0, 0.5])
        .expect("valid");
    let chain = axis(law, effects);
    let speed = 0.01;
    let at = |t: f64| Motion {
        velocity_m_s: speed,
        ..moving(t, speed, speed * t)
    };
    let mut state = chain.start(&Motion {
        velocity_m_s: 0.0,
        ..at(0.0)
    });
    let mut peak: f64 = 0.0;
    let mut broke_at = 0.0;
    let dt = 1e-3;
    for i in 1..2000 {
        let t = dt * f64::from(i);
        let force = chain.step(&mut state, &at(t), dt);
        if state.journal.velocity_m_s == 0.0 && broke_at == 0.0 {
            peak = peak.max(force);
        } else if broke_at == 0.0 {
            broke_at = t;
        } else if state.journal.velocity_m_s > 0.0 {
            assert!(
                (force - 6.0).abs() < 1e-9 || t < broke_at + 2.0 * dt,
                "{t} {force}"
            );
        }
    }
    // The spring of 1000 N/m reaches 9 N after 9 mm, 0.9 s; the damper carries 0.05 N.
    assert!((peak - 9.0).abs() < 0.05, "{peak}");
    assert!((broke_at - 0.9).abs() < 0.02, "{broke_at}");
}

/// The static friction of Coulomb's law has no influence with a rigid drive.
///
/// A reversal without a stop is not a rest.
#[test]
fn coulomb_static_friction_has_no_influence_under_a_rigid_drive() {
    let there = along::<f64>("coulomb", &[6.0, 9.0, 1.0], 0.01, 500, sine(0.05, 2.0));
    let other = along::<f64>("coulomb", &[6.0, 90.0, 1.0], 0.01, 500, sine(0.05, 2.0));
    assert_eq!(there, other);
}
