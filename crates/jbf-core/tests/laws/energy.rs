//! Tests that friction dissipates work over every closed loop.

use super::support::{along, anywhere, in_newtons, sine};
use crate::common::random::Random;

/// Work (J) over the last period of a sinusoidal position, and the sum of its absolute values in
/// the steps (J).
fn loop_work(name: &str, values: &[f64], amplitude_m: f64) -> (f64, f64) {
    let omega = 2.0;
    let steps = 2000;
    let dt = std::f64::consts::TAU / omega / f64::from(steps);
    let at = sine(amplitude_m, omega);
    let force = along::<f64>(name, values, dt, 4 * steps, &at);
    let mut work = 0.0;
    let mut size = 0.0;
    for i in 3 * steps as usize..4 * steps as usize {
        let [a, b] = [i, i + 1].map(|k| at(dt * k as f64).angle_rad);
        let piece: f64 = 0.5 * (force[i] + force[i + 1]) * (b - a);
        work += piece;
        size += piece.abs();
    }
    (work, size)
}

/// Returns true if a law is passive with these parameters.
///
/// LuGre is passive if `sigma_1(v) |v| < 4 sigma_0 g(v)` at every speed (Olsson 1996). The maximum
/// of the left side, at `v_d/sqrt(2)`, is decisive.
fn passive(name: &str, p: &[f64]) -> bool {
    name != "lugre" || p[4] * p[5] * (-0.5_f64).exp() / 2.0_f64.sqrt() < 4.0 * p[0].min(p[1])
}

#[test]
fn closed_loop_dissipates_work_for_passive_laws() {
    let mut random = Random::new(5);
    // The seven-parameter model may return a little: its level falls late, with a deflected spring.
    for law in in_newtons().filter(|law| law.name != "seven_parameter") {
        for _ in 0..150 {
            let values = anywhere(law, &mut random);
            if !passive(law.name, &values) {
                continue;
            }
            let amplitude = random.log_uniform(1e-7, 0.1);
            let (work, size) = loop_work(law.name, &values, amplitude);
            // An elastic loop dissipates nothing: rounding and quadrature errors may appear.
            assert!(
                work > -2e-3 * size,
                "{} {values:?} {amplitude}: {work} of {size}",
                law.name
            );
        }
    }
}

/// The work of Dahl's law over a wide loop is nearly that of a rectangle, 4 F_c A.
#[test]
fn work_of_a_wide_dahl_loop_is_that_of_a_rectangle() {
    let (work, _) = loop_work("dahl", &[8.0, 1e8, 1.0, 0.0], 0.05);
    assert!((work / (4.0 * 8.0 * 0.05) - 1.0).abs() < 2e-3, "{work}");
}
