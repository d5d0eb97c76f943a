"""Build the source archive and the wheel, reproducibly with the same tools.

`python release/build.py --out dist` packs the source archive, unpacks it in an empty folder and
builds the wheel from there, so that the wheel contains only files of the archive. `--target
aarch64-unknown-linux-musl` builds for another machine, with zig as the linker (`pip install
ziglang`; `rustup target add ...`).
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tarfile
import tempfile
from pathlib import Path

from steps import ROOT, clean_environment, run, say

MATURIN = (sys.executable, "-m", "maturin")
BUILD_FOLDER = "jbf-build-"
EPOCH = "315532800"
"""Date of a build if git is not available: 1980, the first date that a zip file can store."""


def build_environment(source: Path) -> dict[str, str]:
    """Return the environment variables of a reproducible build.

    The date is that of the commit, and the binary does not contain paths of this machine.
    """
    environment = clean_environment()
    cargo = Path(environment.get("CARGO_HOME", Path.home() / ".cargo"))
    flags = [f"--remap-path-prefix={source}=/jbf", f"--remap-path-prefix={cargo}=/cargo"]
    return environment | {
        "SOURCE_DATE_EPOCH": _commit_date(),
        "CARGO_ENCODED_RUSTFLAGS": "\x1f".join(flags),
        "CARGO_INCREMENTAL": "0",
        "CARGO_TARGET_DIR": str(source / "target"),
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), environment["PATH"]]),
    }


def _commit_date() -> str:
    if "SOURCE_DATE_EPOCH" in os.environ:
        return os.environ["SOURCE_DATE_EPOCH"]
    if not (ROOT / ".git").exists():
        return EPOCH
    return run(["git", "log", "-1", "--format=%ct"], cwd=ROOT, quiet=True).strip()


def pack(out: Path) -> Path:
    """Build the source archive in the folder `out` and return its path."""
    # Run as a file: importing the package needs the extension, which is not built yet.
    run([sys.executable, ROOT / "python/jbf/workbench/vendored.py"], cwd=ROOT)
    # Not `--sdist` of `maturin build`, which uses a folder with a different name each time.
    run([*MATURIN, "sdist", "--out", out], cwd=ROOT, environment=build_environment(ROOT))
    return max(out.glob("*.tar.gz"), key=lambda path: path.stat().st_mtime)


def build(archive: Path, out: Path, extra: list[str]) -> Path:
    """Build the wheel from a source archive in an empty folder and return its path."""
    with tempfile.TemporaryDirectory(prefix=BUILD_FOLDER) as folder:
        with tarfile.open(archive) as tar:
            tar.extractall(folder, filter="data")
        (source,) = (path for path in Path(folder).iterdir() if path.is_dir())
        wheels = Path(folder) / "wheels"
        command = [*MATURIN, "build", "--out", str(wheels), *extra]
        run(command, cwd=source, environment=build_environment(source))
        (wheel,) = wheels.glob("*.whl")
        shutil.copy(wheel, out)
        return out / wheel.name


def main() -> None:
    """Build the archive and the wheel for the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "dist")
    parser.add_argument("--target", help="Rust's name of another machine; linked by zig")
    parser.add_argument("--interpreter", help="such as 3.14t: for this Python alone, not abi3")
    parser.add_argument("--sdist-only", action="store_true")
    parser.add_argument(
        "--quick",
        action="store_true",
        help="only to see whether it builds: little optimised",
    )
    chosen = parser.parse_args()
    out: Path = chosen.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    archive = pack(out)
    say(f"{archive.name}: {archive.stat().st_size / 1e6:.1f} MB")
    if chosen.sdist_only:
        return
    extra = ["--profile", "quick", "--no-default-features"] if chosen.quick else ["--release"]
    if chosen.target:
        extra += ["--target", chosen.target, "--zig"]
    if chosen.interpreter:
        extra += ["--interpreter", chosen.interpreter]
    wheel = build(archive, out, extra)
    say(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
