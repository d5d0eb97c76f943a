"""Test a wheel with the oldest versions of its dependencies that pyproject.toml allows.

`python release/lowest.py dist` installs the wheel with each direct dependency at its lowest allowed
version (`uv pip install --resolution lowest-direct`), extras included, on Python 3.10 if available.
It then runs the tests of `wheel_test.py` and those of the extras.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from steps import ROOT, make_environment, run, say
from wheel_test import TESTS, TOOLS, find_wheel, run_tests

EXTRAS = ("formats", "workbench")
TESTS_OF_EXTRAS = ("importing/test_formats", "workbench/test_guard", "workbench/test_session")
FROM_SOURCE = ("mat-io",)
"""Packages in pure Python that have no wheels."""


def oldest_python() -> str:
    """Return the path of Python 3.10, or of this interpreter if it is not available."""
    # pyenv's command of that name does nothing unless the version is selected.
    kept = sorted(Path.home().glob(".pyenv/versions/3.10.*/bin/python3.10"))
    for found in [shutil.which("python3.10"), *map(str, kept)]:
        if found and not subprocess.run([found, "-V"], capture_output=True, check=False).returncode:
            return found
    print("no Python 3.10: the floors are tried on this Python", file=sys.stderr)
    return sys.executable


def check_floors(installed: dict[str, str]) -> None:
    """Fail if a lowest version was not installed because it does not support this Python."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    kept = text[text.index("\ndependencies") : text.index("\ndev = ")]
    wrong = []
    for name, floor in dict(re.findall(r'"([\w.-]+)>=([\d.]+)', kept)).items():
        found = installed.get(name.lower())
        if found is not None and re.match(rf"{re.escape(floor)}(\.|$)", found) is None:
            wrong.append(f"{name}>={floor}: the lowest that goes is {found}")
    if wrong:
        sys.exit("\n".join([*wrong, "raise the floors in pyproject.toml"]))


def main() -> None:
    """Install the wheel and run the tests for the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dist", type=Path, help="a wheel, or the folder of one")
    parser.add_argument("--python", default=oldest_python())
    chosen = parser.parse_args()
    wheel = find_wheel(chosen.dist)
    with tempfile.TemporaryDirectory(prefix="jbf-lowest-") as name:
        folder = Path(name)
        tools = make_environment(folder / "tools")
        run([tools, "-m", "pip", "install", "--quiet", "uv"], cwd=folder)
        python = make_environment(folder / "environment", chosen.python)
        uv = [tools, "-m", "uv", "pip"]
        install = [*uv, "install", "--quiet", "--python", python, "--resolution", "lowest-direct"]
        only = ["--only-binary", ":all:", *(f"--no-binary={name}" for name in FROM_SOURCE)]
        extras = [word for extra in EXTRAS for word in ("--extra", extra)]
        run([*install, *only, "-r", ROOT / "pyproject.toml", *extras], cwd=folder)
        run([*uv, "install", "--quiet", "--python", python, "--no-deps", wheel], cwd=folder)
        # Test tools are not subject to the lowest versions; old starlettes test with httpx.
        run([*uv, "install", "--quiet", "--python", python, *TOOLS, "httpx", "httpx2"], cwd=folder)
        version = run([python, "-V"], cwd=folder)
        listed = run([*uv, "list", "--python", python, "--format", "json"], cwd=folder, quiet=True)
        installed = {p["name"]: p["version"] for p in json.loads(listed[listed.index("[") :])}
        print(*(f"{name} {number}" for name, number in installed.items()), sep=", ")
        # A later Python has no wheels of the oldest versions.
        if version.startswith("Python 3.10."):
            check_floors(installed)
        run_tests(python, folder, [*TESTS, *TESTS_OF_EXTRAS])
    say(f"{wheel.name} passed with the oldest versions in {ROOT / 'pyproject.toml'}")


if __name__ == "__main__":
    main()
