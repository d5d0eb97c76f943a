//! Tests that the modules of the crate import each other without cycles.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Paths of all files of a module.
fn files(at: &Path) -> Vec<PathBuf> {
    if at.is_file() {
        return vec![at.to_path_buf()];
    }
    let entries = fs::read_dir(at).expect("a folder");
    entries
        .flat_map(|entry| files(&entry.expect("an entry").path()))
        .collect()
}

/// Modules of the crate with the modules that each imports; a module is a file or a folder in
/// `src`.
///
/// Comments and the tests in a module are excluded. A top-level export of `lib.rs` (`crate::Dual`)
/// belongs to its module.
fn imports() -> BTreeMap<String, BTreeSet<String>> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let entries = fs::read_dir(&src).expect("the sources");
    let modules: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    let name = |p: &Path| {
        p.file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned()
    };
    let names: BTreeSet<String> = modules.iter().map(|p| name(p)).collect();
    let mut found = BTreeMap::new();
    for module in modules.iter().filter(|p| name(p) != "lib") {
        let mut wanted = BTreeSet::new();
        for file in files(module) {
            let text = fs::read_to_string(&file).expect("source");
            let text = text
                .split("#[cfg(test)]\nmod tests")
                .next()
                .unwrap_or_default();
            for line in text.lines().filter(|l| !l.trim_start().starts_with("//")) {
                for (at, _) in line.match_indices("crate::") {
                    let rest = &line[at + "crate::".len()..];
                    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
                    let word = rest[..end.unwrap_or(rest.len())].to_lowercase();
                    assert!(names.contains(&word), "{}: {line}", file.display());
                    wanted.insert(word);
                }
            }
        }
        wanted.remove(&name(module));
        found.insert(name(module), wanted);
    }
    found
}

#[test]
fn modules_do_not_import_each_other_in_a_cycle() {
    let mut left = imports();
    assert!(left.len() > 20 && left["chain"].contains("effect"));
    // Remove repeatedly the modules that import no remaining module, and those that no remaining
    // module imports.
    loop {
        let done: Vec<String> = left
            .iter()
            .filter(|(module, wanted)| {
                wanted.iter().all(|w| !left.contains_key(w))
                    || !left.values().any(|wanted| wanted.contains(*module))
            })
            .map(|(module, _)| module.clone())
            .collect();
        if done.is_empty() {
            break;
        }
        for module in done {
            left.remove(&module);
        }
    }
    assert!(left.is_empty(), "these import each other: {left:#?}");
}
