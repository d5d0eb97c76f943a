//! Tests of rules for all effects of the catalogue, and of a closed form for each effect.

#[path = "../common/mod.rs"]
mod common;

mod backlash;
mod cogging;
mod cogging_2;
mod coulomb_drag;
mod derivatives;
mod direction_asymmetry;
mod drive_compliance;
mod dry_asymmetry;
mod dry_load_dependence;
mod dry_temperature_dependence;
mod dwell_stiction;
mod film_memory;
mod finite;
mod gravity;
mod inertia;
mod load_dependence;
mod null;
mod pitch_ripple;
mod pitch_ripple_2;
mod position_ripple;
mod presliding;
mod quadratic_drag;
mod running_in;
mod sensor_drift;
mod sensor_hysteresis;
mod sensor_lag;
mod sensor_nonlinearity;
mod sensor_offset;
mod shear_thinning;
mod spring;
mod stribeck_asymmetry;
mod stribeck_excess;
mod stroke_dependence;
mod symmetry;
mod thermal_thinning;
mod time_delay;
mod together;
mod torque_proportional;
mod viscous_asymmetry;
mod viscous_load_dependence;
mod viscous_temperature_dependence;
mod viscous_thinning;
mod vogel_viscosity;
mod warm_up;
mod zero_load_dependence;

/// Every effect has a test file with its name, declared in this file, that contains at least one
/// test.
#[test]
fn every_effect_of_the_catalogue_has_a_test_of_its_closed_form() {
    let here = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/effects");
    for info in jbf_core::effect::CATALOGUE {
        let name = info.name;
        let named = include_str!("main.rs").contains(&format!("\nmod {name};\n"));
        let text = std::fs::read_to_string(format!("{here}/{name}.rs")).unwrap_or_default();
        assert!(
            named && text.contains("#[test]"),
            "{name} has no closed form: write {here}/{name}.rs and name it in main.rs"
        );
    }
}
