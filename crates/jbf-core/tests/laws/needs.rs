//! Tests of the compatibility of effects and laws.

use jbf_core::effect::{self, Need};
use jbf_core::law;

fn lacking(effect: &str, law: &str) -> Option<Need> {
    let effect = effect::CATALOGUE.iter().find(|e| e.name == effect);
    let law = law::CATALOGUE.iter().find(|l| l.name == law);
    effect.expect("known").lacking(law.expect("known"))
}

#[test]
fn only_effects_of_drives_are_refused_by_a_bearing() {
    let refused: Vec<_> = effect::CATALOGUE
        .iter()
        .filter(|effect| lacking(effect.name, "journal").is_some())
        .map(|effect| (effect.name, lacking(effect.name, "journal")))
        .collect();
    let of_drives = [
        "dry_load_dependence",
        "viscous_load_dependence",
        "viscous_asymmetry",
        "dry_temperature_dependence",
        "viscous_temperature_dependence",
        "viscous_thinning",
        "dry_asymmetry",
        "stribeck_asymmetry",
        "stroke_dependence",
        "pitch_ripple",
        "pitch_ripple_2",
        "warm_up",
        "torque_proportional",
        "zero_load_dependence",
        "gravity",
        "spring",
        "cogging",
        "cogging_2",
    ];
    assert_eq!(refused, of_drives.map(|name| (name, Some(Need::NoFilm))));
    for name in of_drives {
        for law in law::CATALOGUE.iter().filter(|l| !l.has_film) {
            assert_eq!(lacking(name, law.name), None);
        }
    }
}

#[test]
fn effects_that_do_not_apply_to_a_law_are_refused() {
    for law in law::CATALOGUE.iter().filter(|l| !l.has_film) {
        assert_eq!(lacking("thermal_thinning", law.name), Some(Need::Film));
        assert_eq!(lacking("vogel_viscosity", law.name), Some(Need::Film));
        assert_eq!(lacking("sensor_lag", law.name), None);
        let bristle = law.has_bristle.then_some(Need::NoBristle);
        assert_eq!(lacking("presliding", law.name), bristle);
        assert_eq!(lacking("drive_compliance", law.name), bristle);
        let dry = law.has_dry_level.then_some(Need::NoDryLevel);
        assert_eq!(lacking("coulomb_drag", law.name), dry);
    }
}
