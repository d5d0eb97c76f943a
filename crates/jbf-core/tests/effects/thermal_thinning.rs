//! Tests that the logarithm of the viscosity finally falls by `beta q tau P` at a constant friction
//! power P.

use crate::common::constant_law::ConstantLaw;
use crate::common::motion::constant;
use crate::common::{chain_round, LOAD_N};

#[test]
fn temperature_rise_follows_its_closed_form() {
    let (f, speed, rate_1_j, tau) = (0.1, 0.05, 0.03, 20.0);
    let chain = chain_round(ConstantLaw(f), &[("thermal_thinning", &[rate_1_j, tau])]);
    let end = rate_1_j * tau * (f * LOAD_N * speed);
    for dt in [0.01, 0.5, 7.0] {
        let mut state = chain.start(&constant::<f64>(speed, 0.0));
        let steps = (10.0 * tau / dt) as u32;
        for i in 1..=steps {
            // The film uses the viscosity at the start of the step.
            let from = dt * f64::from(i - 1);
            chain.step(&mut state, &constant(speed, dt * f64::from(i)), dt);
            let thinned = -(state.law / speed).ln();
            let expected = end * (1.0 - (-from / tau).exp());
            assert!(
                (thinned - expected).abs() < 1e-12,
                "dt {dt}, step {i}: {thinned} {expected}"
            );
        }
        assert!((-(state.law / speed).ln() / end - 1.0).abs() < 1e-4);
    }
}

/// The steady friction of a warm film is that of the unchanged film at a lower speed, the effective
/// speed.
///
/// The coefficient does not depend on the viscosity in any other way.
#[test]
fn warm_film_has_the_steady_friction_of_a_lower_speed() {
    use crate::common::{chain, law};
    let (rate_1_j, tau, speed) = (2.0, 5.0, 0.05);
    let chain = chain::<f64>(&[("thermal_thinning", &[rate_1_j, tau])]);
    let mut state = chain.start(&constant(speed, 0.0));
    for i in 1..=40_000 {
        chain.step(&mut state, &constant(speed, 0.01 * f64::from(i)), 0.01);
    }
    let thinning = (-rate_1_j * tau * state.force_n * speed).exp();
    let steady = law::<f64>(jbf_core::Clock::Journal)
        .steady(speed * thinning)
        .expect("a speed");
    assert!(thinning < 0.8, "{thinning}");
    assert!((state.force_n / LOAD_N - steady.coefficient).abs() < 1e-9);
}
