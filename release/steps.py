"""Common functions of the release programs: commands, and a clean environment."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_LEAKS = (
    "PYTHON", "VIRTUAL_ENV", "CONDA", "PYTEST", "COVERAGE", "RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_BUILD_", "CARGO_PROFILE_", "CARGO_TARGET_", "CARGO_INCREMENTAL", "MATURIN_", "PYO3_",
)  # fmt: skip
"""Prefixes of environment variables that would affect a build or a test."""


def clean_environment() -> dict[str, str]:
    """Return the environment of this process without variables that affect a build or a test."""
    return {k: v for k, v in os.environ.items() if not k.startswith(_LEAKS)}


def say(text: str) -> None:
    """Print a progress line immediately."""
    print(f"-- {text}", flush=True)


def run(
    command: Sequence[str | Path],
    *,
    cwd: Path,
    environment: Mapping[str, str] | None = None,
    quiet: bool = False,
) -> str:
    """Run a command and return its output; a failure ends the program with that output."""
    words = [str(word) for word in command]
    done = subprocess.run(
        words,
        cwd=cwd,
        env=dict(clean_environment() if environment is None else environment),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode or not quiet:
        print(done.stdout, end="", flush=True)
    if done.returncode:
        sys.exit(f"{' '.join(words)}: exit code {done.returncode}")
    return done.stdout


def make_environment(folder: Path, python: str = sys.executable) -> Path:
    """Create a new virtual environment and return the path of its interpreter."""
    # Use the base interpreter, not a virtual environment that contains it.
    base = run([python, "-c", "import sys; print(sys._base_executable)"], cwd=ROOT, quiet=True)
    run([base.strip(), "-m", "venv", folder], cwd=ROOT, quiet=True)
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def tracked_files() -> list[Path]:
    """Return the files that git tracks or would add, relative to the root."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"]
    names = run(listed, cwd=ROOT, quiet=True).split("\0")
    return [Path(name) for name in names if name and (ROOT / name).is_file()]
