//! Tests that the fingerprints of this build equal those of the table.
//!
//! `make bits` repeats the test for debug, release and native builds.

use jbf_trace::{check, traces, Hash, Trace, TABLE};
use std::collections::BTreeMap;

#[test]
fn every_fingerprint_equals_that_of_the_table() {
    let mut wrong = Vec::new();
    let mut new = Vec::new();
    let found = check(|trace, expected| match expected {
        Some(hash) if hash == trace.hash => {}
        Some(_) => wrong.push(*trace),
        None => new.push(trace.name),
    });
    assert!(
        wrong.is_empty(),
        "bits changed; where that is meant, say `make bits-table`: {wrong:#?}"
    );
    assert!(
        found.same as usize == TABLE.len(),
        "the table names what is no more"
    );
    assert!(
        new.is_empty(),
        "not in the table yet, `make bits-table` adds them: {new:?}"
    );
}

/// Hashes of different computations differ from each other and from that of an empty sequence.
#[test]
fn fingerprints_differ_between_computations() {
    let mut seen: BTreeMap<u64, Vec<Trace>> = BTreeMap::new();
    traces::<f64>("f64", &mut |t| seen.entry(t.hash).or_default().push(*t));
    assert!(!seen.contains_key(&Hash::default().0));
    for same in seen.values().filter(|s| s.len() > 1) {
        // The first law's own run is also that of its chain; every effect must change the hash. A
        // second wave alone equals the first.
        let mut effects: Vec<&str> = same
            .iter()
            .filter(|t| t.group == "effect")
            .map(first)
            .collect();
        effects.dedup();
        assert!(
            effects.is_empty() || (effects.len() == 1 && same.iter().all(|t| t.group == "effect")),
            "{same:?}"
        );
    }
}

/// Name of the effect, or of the effect of which it is a second instance.
fn first(trace: &Trace) -> &'static str {
    let info = jbf_core::effect::CATALOGUE
        .iter()
        .find(|info| info.name == trace.name)
        .expect("an effect of the catalogue");
    info.further_of.unwrap_or(info.name)
}

#[test]
fn hash_changes_with_one_bit_of_input() {
    let of = |number: f64| {
        let mut hash = Hash::default();
        hash.take(1.0);
        hash.take(number);
        hash
    };
    assert_ne!(of(0.1), of(0.1_f64.next_up()));
    assert_ne!(of(0.0), of(-0.0));
}
