//! Tests of the discretisation errors of the laws.
//!
//! Laws that depend on the distance alone are exact for any step along the same path; the errors of
//! the others fall with the square of the step.

use super::support::{along, sine, starts};
use jbf_core::law::CATALOGUE;

/// RMS difference of a run from one with steps sixty-four times shorter, over the last of four
/// periods.
fn error(name: &str, per_period: u32, amplitude: f64) -> f64 {
    let law = CATALOGUE.iter().find(|l| l.name == name).expect("known");
    let omega = 5.0;
    let run = |n: u32| {
        let dt = std::f64::consts::TAU / omega / f64::from(n);
        // Shifted by a quarter of a step, so that no sample is at a reversal.
        let at = sine(amplitude, omega);
        let shift = 0.25 * std::f64::consts::TAU / omega / 100.0;
        along::<f64>(name, &starts(law), dt, 4 * n, |t| at(t + shift))
    };
    let (coarse, fine) = (run(per_period), run(64 * per_period));
    let squares = (3 * per_period..4 * per_period)
        .map(|i| (coarse[i as usize] - fine[64 * i as usize]).powi(2));
    (squares.sum::<f64>() / f64::from(per_period)).sqrt()
}

#[test]
fn error_of_a_lugre_run_is_of_second_order_in_the_step() {
    let errors = [500, 1000, 2000].map(|n| error("lugre", n, 2e-4));
    assert!(errors[0] < 0.05, "{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
    }
}

#[test]
fn error_of_a_dahl_run_is_that_of_the_interpolated_distance() {
    // The error is that of the distance with linear speed; the law adds none.
    let errors = [500, 1000].map(|n| error("dahl", n, 2e-4));
    assert!(
        errors[0] < 1e-3 && errors[0] / errors[1] > 3.0,
        "{errors:?}"
    );
}

#[test]
fn laws_without_memory_have_no_step_error() {
    assert_eq!(error("stribeck", 100, 0.02), 0.0);
    assert_eq!(error("coulomb", 100, 0.02), 0.0);
}
