//! Tests that the SimpleFOC sketch compiles as C++, and reduces the velocity error of a simulated
//! motor.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Static library of this crate, which cargo builds together with the tests.
///
/// Its name contains a hash, and earlier builds may remain: the newest is that of the tests.
fn static_library() -> PathBuf {
    let test = std::env::current_exe().expect("the path of the test");
    let folder = test.parent().expect("the folder of the tests");
    let built = |path: &PathBuf| path.metadata().and_then(|m| m.modified()).ok();
    std::fs::read_dir(folder)
        .expect("the files next to the test")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| {
            let name = path.file_name().map(|name| name.to_string_lossy());
            name.is_some_and(|name| name.starts_with("libjbf_c") && name.ends_with(".a"))
        })
        .max_by_key(built)
        .expect("libjbf_c next to the test")
}

#[test]
fn sketch_reduces_the_velocity_error_to_a_fifth() {
    if Command::new("c++").arg("--version").output().is_err() {
        eprintln!("skipped: no C++ compiler");
        return;
    }
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("simplefoc");
    let compiled = Command::new("c++")
        .args(["-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror"])
        .arg("-I")
        .arg(crate_folder.join("include"))
        .arg("-I")
        .arg(crate_folder.join("tests/simplefoc"))
        .arg(crate_folder.join("tests/simplefoc/main.cpp"))
        .arg(static_library())
        .args(["-lm", "-lpthread", "-ldl", "-o"])
        .arg(&program)
        .output()
        .expect("the C++ compiler runs");
    assert!(
        compiled.status.success(),
        "{}",
        String::from_utf8_lossy(&compiled.stderr)
    );
    let run = Command::new(&program).output().expect("the program runs");
    assert!(run.status.success());
    let printed = String::from_utf8_lossy(&run.stdout);
    let errors: Vec<f64> = printed
        .split_whitespace()
        .map(|word| word.parse().expect("a number"))
        .collect();
    assert!(errors[0] < 0.2 * errors[1], "rad/s: {printed}");
}
