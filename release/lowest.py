"""Do the oldest versions that pyproject.toml allows still do?

`python release/lowest.py dist` installs the wheel with each direct dependency at its floor
(`uv pip install --resolution lowest-direct`), extras included, on Python 3.10 where there is one,
and runs the tests of `wheel_test.py` and those of the extras.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from steps import ROOT, make_environment, run, say
from wheel_test import TESTS, TOOLS, find_wheel, run_tests

EXTRAS = "formats,workbench"
TESTS_OF_EXTRAS = ("test_import_formats", "workbench/test_guard", "workbench/test_session")
FROM_SOURCE = ("mat-io",)
"""Without wheels; pure Python."""


def oldest_python() -> str:
    """Python 3.10, or this one."""
    found = shutil.which("python3.10")
    # A shim of a version manager may be there without its Python.
    works = (
        found and subprocess.run([found, "-V"], capture_output=True, check=False).returncode == 0
    )
    if not works:
        print("no Python 3.10: the floors are tried on this Python", file=sys.stderr)
    return found if found and works else sys.executable


def main() -> None:
    """Command line."""
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
        run([*install, *only, f"jbf[{EXTRAS}] @ {wheel.as_uri()}"], cwd=folder)
        # Tools of the tests are not what is tried.
        run([*uv, "install", "--quiet", "--python", python, *TOOLS, "httpx2"], cwd=folder)
        run([python, "-V"], cwd=folder)
        run([*uv, "list", "--python", python], cwd=folder)
        run_tests(python, folder, [*TESTS, *TESTS_OF_EXTRAS])
    say(f"{wheel.name} passed with the oldest versions in {ROOT / 'pyproject.toml'}")


if __name__ == "__main__":
    main()
