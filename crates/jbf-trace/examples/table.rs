//! Prints every fingerprint and whether it agrees with the table; exits with code 1 if one does
//! not.
//!
//! `make bits` runs this program in every supported build; `--write FILE` writes a new table.

use jbf_trace::check;
use std::fmt::Write;

fn main() -> std::io::Result<()> {
    let mut args = std::env::args().skip(1);
    let file = (args.next().as_deref() == Some("--write")).then(|| args.next());
    let mut rows = String::new();
    let quiet = file.is_some();
    let found = check(|t, expected| {
        let (group, name, kind, hash) = (t.group, t.name, t.kind, t.hash);
        let _ = writeln!(
            rows,
            "    Trace {{ group: {group:?}, name: {name:?}, kind: {kind:?}, hash: {hash:#018x} }},"
        );
        if !quiet {
            let verdict = match expected {
                Some(expected) if expected == hash => "",
                Some(_) => "  DIFFERS",
                None => "  not in the table",
            };
            println!("{kind} {hash:016x}  {group:8} {name}{verdict}");
        }
    });
    if let Some(file) = file.flatten() {
        let begin = "//! Written by `make bits-table`.\n\nuse crate::Trace;\n\n\
                     /// Fingerprints that every target must have.\n#[rustfmt::skip]\n\
                     pub const TABLE: &[Trace] = &[\n";
        return std::fs::write(file, format!("{begin}{rows}];\n"));
    }
    let [same, different, unknown] = [found.same, found.different, found.unknown];
    println!("{same} as the table has them, {different} differ, {unknown} not in the table");
    if different > 0 {
        std::process::exit(1);
    }
    Ok(())
}
