//! Tests that the first page lists every law and effect of the catalogues with its equation.

use jbf_core::{effect, law};

const README: &str = include_str!("../README.md");

/// Row of a table: name, equation and memory.
fn row(name: &str, equation: &str, has_memory: bool) -> String {
    let equation = equation.replace('|', "\\|");
    let memory = if has_memory { "yes" } else { "no" };
    format!("| `{name}` | `{equation}` | {memory} |")
}

#[test]
fn every_law_and_effect_has_a_row_with_its_equation() {
    let laws = law::CATALOGUE
        .iter()
        .map(|l| row(l.name, l.equation, l.has_memory));
    let effects = effect::CATALOGUE
        .iter()
        .map(|e| row(e.name, e.equation, e.has_memory));
    let missing: Vec<_> = laws
        .chain(effects)
        .filter(|row| !README.contains(row.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "the README lacks:\n{}",
        missing.join("\n")
    );
}
