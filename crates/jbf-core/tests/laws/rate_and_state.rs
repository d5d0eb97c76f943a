//! Tests of the rate-and-state law: steady sliding, steps of the speed, rests, and the
//! regularisation at zero speed.

use super::support::{along, gap, moving, sine};
use jbf_core::law::rate_and_state::RateAndState;
use jbf_core::law::{Law, Named, SteadyCurve};
use jbf_core::Clock;

const F_0: f64 = 8.0;
const A: f64 = 0.12;
const B: f64 = 0.17;
const D_C: f64 = 2e-5;
const V_0: f64 = 1e-3;
const VALUES: [f64; 6] = [F_0, A, B, D_C, V_0, 0.0];

fn law(values: [f64; 6]) -> RateAndState<f64> {
    RateAndState::build(None, None, &values, Clock::Journal).expect("valid")
}

/// Age of the contact (s) for a force in sliding, from the equation of the law.
fn age_s(force: f64, speed: f64) -> f64 {
    D_C / V_0 * ((force - F_0 - A * (speed / V_0).ln()) / B).exp()
}

#[test]
fn steady_friction_changes_by_a_minus_b_per_e_fold_of_the_speed() {
    for v in [1e-9, 1e-5, V_0, 0.3, 40.0] {
        let steady = law(VALUES).steady_n(-v).expect("moving");
        let expected = F_0 + (A - B) * (v / V_0).ln();
        assert!((steady + expected).abs() < 1e-13 * F_0, "{v}: {steady}");
    }
    let viscous = [F_0, A, B, D_C, V_0, 3.0];
    let added = law(viscous).steady_n(0.5).expect("moving") - law(VALUES).steady_n(0.5).expect("");
    assert!((added - 1.5).abs() < 1e-12);
}

#[test]
fn friction_after_a_speed_step_jumps_by_a_and_settles_over_the_slip_distance() {
    for (slow, fast) in [(1e-4, 1e-3), (1e-3, 1e-4), (2e-3, 3e-3)] {
        // The change takes the first step, of a hundred-thousandth of the slip distance.
        let dt = 1e-5 * D_C / f64::max(slow, fast);
        let at = |t: f64| moving(t, if t < 0.5 * dt { slow } else { fast }, 0.0);
        let force = along::<f64>("rate_and_state", &VALUES, dt, 400_000, at);
        let jump = force[1] - force[0];
        let direct = A * f64::ln(fast / slow);
        assert!((jump - direct).abs() < 2e-5 * B, "{jump} {direct}");
        let (begin, settled) = (age_s(force[1], fast), D_C / fast);
        for (i, f) in force.iter().enumerate().skip(1).step_by(1000) {
            let way = fast * dt * (i as f64 - 1.0);
            let age = settled + (begin - settled) * (-way / D_C).exp();
            let expected = F_0 + A * (fast / V_0).ln() + B * (V_0 * age / D_C).ln();
            assert!((f - expected).abs() < 1e-9, "{i}: {f} {expected}");
        }
    }
}

/// At constant speed, the age does not depend on the time step.
#[test]
fn age_at_constant_speed_does_not_depend_on_the_step() {
    for steps in [1, 3, 50] {
        let (speed, span) = (1e-3, 0.06);
        let dt = span / f64::from(steps);
        let law = law(VALUES);
        let mut age = 7.0;
        for _ in 0..steps {
            law.advance(&mut age, [speed; 3], 1.0, dt);
        }
        let expected = D_C / speed + (7.0 - D_C / speed) * (-speed * span / D_C).exp();
        assert!((age / expected - 1.0).abs() < 1e-12, "{age} {expected}");
    }
}

/// A contact at rest ages; its breakaway force rises by b if the duration of the rest increases by
/// a factor of e.
#[test]
fn friction_after_a_rest_rises_with_the_logarithm_of_its_duration() {
    let law = law(VALUES);
    let after = |rest: f64| {
        let mut age = D_C / V_0;
        law.advance(&mut age, [0.0; 3], 1.0, rest);
        (
            age,
            law.friction(&age, V_0).jump,
            law.friction(&age, 0.0).jump,
        )
    };
    let ((short, begin, held), (long, end, longer)) = (after(1.0), after(100.0));
    assert!((short - 1.0 - D_C / V_0).abs() < 1e-12);
    assert!((end - begin - B * (long / short).ln()).abs() < 1e-12);
    // At rest it holds up to the force of steady sliding at its age.
    assert!((longer - held - (B - A) * (long / short).ln()).abs() < 1e-12);
    assert!((held - law.steady_n(D_C / short).expect("moving")).abs() < 1e-12);
}

#[test]
fn friction_near_zero_speed_is_the_inverse_hyperbolic_sine() {
    // A large direct effect, so that creep is within reach of the numbers.
    let law = law([1.0, 0.4, 0.1, D_C, V_0, 0.0]);
    let age = 3.0 * D_C / V_0;
    let psi = 1.0 + 0.1 * 3.0_f64.ln();
    for power in -300..40 {
        let v = V_0 * 10.0_f64.powf(0.1 * f64::from(power));
        let expected = 0.4 * (v / (2.0 * V_0) * (psi / 0.4).exp()).asinh();
        let own = law.friction(&age, v).jump;
        assert!((own - expected).abs() < 1e-12, "{v}: {own} {expected}");
    }
}

/// Long steps with a linearly changing speed, with and without reversals, agree with short ones.
#[test]
fn long_steps_are_stable_and_accurate_to_a_quarter_of_b() {
    let law = law(VALUES);
    for power in -20..60 {
        let dt = 1e-3 * 10.0_f64.powf(0.1 * f64::from(power));
        for (begin, end) in [(0.0, 2e-3), (2e-3, 0.0), (1e-3, 2e-3), (2e-3, 5e-4)] {
            for first in [1e-5, 0.01, 10.0] {
                let speed = |share: f64| begin + (end - begin) * share;
                let (mut age, mut fine) = (first, first);
                law.advance(&mut age, [begin, speed(0.5), end], 1.0, dt);
                let n = 4000;
                for i in 0..n {
                    let at = |k: f64| speed((f64::from(i) + k) / f64::from(n));
                    law.advance(
                        &mut fine,
                        [at(0.0), at(0.5), at(1.0)],
                        1.0,
                        dt / f64::from(n),
                    );
                }
                let off = (age / fine).ln().abs();
                assert!(off < 0.25, "{dt} {begin} {end} {first}: {off}");
            }
        }
    }
}

#[test]
fn law_without_both_effects_equals_coulombs_law() {
    let run =
        |name: &str, values: &[f64]| along::<f64>(name, values, 2.03e-3, 3000, sine(0.02, 3.0));
    let own = run("rate_and_state", &[F_0, 0.0, 0.0, D_C, V_0, 30.0]);
    let coulomb = run("coulomb", &[F_0, 9.0, 30.0]);
    assert!(gap(&own, &coulomb) < 1e-12, "{}", gap(&own, &coulomb));
}

/// Friction is finite and not negative for extreme ages and speeds in single precision.
#[test]
fn friction_is_finite_and_not_negative_in_single_precision() {
    for a in [0.0_f32, 1e-30, 0.1, 1e7] {
        for b in [0.0_f32, 0.1, 1e7] {
            for slip in [2e-12_f32, 1e3] {
                let values = [8.0, a, b, slip, 1e-7, 0.0];
                let law = RateAndState::build(None, None, &values, Clock::Journal).expect("valid");
                let mut age = law.start(1.0);
                for v in [0.0_f32, 1e-40, 1e-10, 1.0, 1e30, 0.0, 1e4] {
                    for dt in [1e-12_f32, 1.0, 1e30] {
                        law.advance(&mut age, [v; 3], 1.0, dt);
                        let jump = law.friction(&age, v).jump;
                        assert!(age > 0.0 && age.is_finite(), "{age}");
                        assert!(
                            jump >= 0.0 && jump.is_finite(),
                            "{values:?} {v} {dt}: {jump}"
                        );
                    }
                }
            }
        }
    }
}
