//! Tests that the declarations of `jbf.h` match the library, including the sizes.

use jbf_c::SIZES;
use jbf_core::law::CATALOGUE;

const HEADER: &str = include_str!("../include/jbf.h");

#[test]
fn header_declares_the_sizes_of_every_law() {
    let declared: Vec<(String, String, usize, usize)> = HEADER
        .lines()
        .filter_map(|line| line.strip_prefix("JBF_DECLARE(")?.strip_suffix(')'))
        .map(|inside| {
            let parts: Vec<&str> = inside.split(", ").collect();
            let words = |i: usize| parts[i].parse().expect("a number of words");
            (parts[0].into(), parts[1].into(), words(3), words(4))
        })
        .collect();
    let built: Vec<_> = SIZES
        .iter()
        .map(|&(law, kind, model, state)| (law.into(), kind.into(), model, state))
        .collect();
    assert_eq!(declared, built);
}

#[test]
fn every_catalogue_law_is_exported_in_both_precisions() {
    for page in CATALOGUE {
        for kind in ["f32", "f64"] {
            assert!(
                SIZES.iter().any(|s| s.0 == page.name && s.1 == kind),
                "{} in {kind} is missing: add it to `laws!` and to jbf.h",
                page.name
            );
        }
    }
}
