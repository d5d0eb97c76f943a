//! Tests of limits in which one law becomes another.

use super::support::{along, gap, sine};

const STEPS: u32 = 3000;
/// Time step, s, with which no sample is within a few deflections of a stiff bristle after a
/// reversal.
const DT_S: f64 = 2.03e-3;

#[test]
fn stiff_dahl_law_equals_coulombs_law() {
    let stiff = along::<f64>(
        "dahl",
        &[8.0, 1e12, 1.0, 30.0],
        DT_S,
        STEPS,
        sine(0.02, 3.0),
    );
    let rigid = along::<f64>("coulomb", &[8.0, 9.0, 30.0], DT_S, STEPS, sine(0.02, 3.0));
    assert!(gap(&stiff, &rigid) < 1e-9, "{}", gap(&stiff, &rigid));
}

#[test]
fn stiff_lugre_law_equals_the_stribeck_law() {
    let values = [8.0, 12.0, 0.01, 1e12, 0.0, 0.1, 30.0];
    let stiff = along::<f64>("lugre", &values, DT_S, STEPS, sine(0.02, 3.0));
    let values = [8.0, 12.0, 0.01, 2.0, 30.0];
    let rigid = along::<f64>("stribeck", &values, DT_S, STEPS, sine(0.02, 3.0));
    assert!(gap(&stiff, &rigid) < 1e-6, "{}", gap(&stiff, &rigid));
}

#[test]
fn lugre_law_without_stribeck_effect_and_damping_equals_dahls_law() {
    let values = [8.0, 8.0, 0.01, 1e5, 0.0, 0.1, 30.0];
    let lugre = along::<f64>("lugre", &values, DT_S, STEPS, sine(2e-4, 3.0));
    let dahl = along::<f64>("dahl", &[8.0, 1e5, 1.0, 30.0], DT_S, STEPS, sine(2e-4, 3.0));
    assert!(gap(&lugre, &dahl) < 1e-9, "{}", gap(&lugre, &dahl));
}

#[test]
fn stiff_seven_parameter_law_without_stribeck_effect_equals_coulombs_law() {
    let values = [1e12, 8.0, 30.0, 1e-6, 0.01, 0.0, 1.0];
    let seven = along::<f64>("seven_parameter", &values, DT_S, STEPS, sine(0.02, 3.0));
    let rigid = along::<f64>("coulomb", &[8.0, 9.0, 30.0], DT_S, STEPS, sine(0.02, 3.0));
    assert!(gap(&seven, &rigid) < 2e-6, "{}", gap(&seven, &rigid));
}

/// As its exponent approaches zero, Dahl's law becomes a spring with a slider, as the
/// elasto-plastic law.
#[test]
fn dahl_law_with_an_exponent_near_zero_is_a_spring_with_slider() {
    let dahl = along::<f64>("dahl", &[8.0, 1e5, 0.01, 0.0], DT_S, STEPS, sine(2e-4, 3.0));
    let values = [1e5, 8.0, 0.0, 1e-6, 0.01, 0.0, 1.0];
    let seven = along::<f64>("seven_parameter", &values, DT_S, STEPS, sine(2e-4, 3.0));
    assert!(gap(&dahl, &seven) < 0.3, "{}", gap(&dahl, &seven));
}
