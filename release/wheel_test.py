"""Test a wheel as a user installs it: install it, run a diagnosis, and run the tests.

`python release/wheel_test.py dist/*.whl`. The program uses a new environment in a separate folder,
and compiles nothing (`--only-binary`). The tests are copied to this folder without the package, so
that they import the installed one.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
import zipfile
from pathlib import Path

from build import BUILD_FOLDER
from steps import ROOT, make_environment, run, say, tracked_files

TESTS = (
    "cli/test_commands", "cli/test_parallel_calls", "comparison/test_comparison",
    "control/test_tuning", "estimation/test_fit", "importing/test_clocks",
    "importing/test_headers", "models/test_batch", "models/test_model", "models/test_model_file",
    "project/test_lazy_imports", "records/test_channels", "records/test_rig",
    "records/test_run", "reporting/test_text_reports",
)  # fmt: skip
"""Test files of each package that need no extra and no other files, and take a minute or two."""
COPIED = ("python/tests/", "simulator/", "benches/", "pyproject.toml")
TOOLS = ("pytest>=8", "hypothesis>=6.100", "filelock>=3.12")
MUST_HOLD = (
    "jbf/_core.pyi",
    "jbf/py.typed",
    "jbf/data/",
    "jbf/workbench/static/",
    "jbf/workbench/vendored_files/uPlot.iife.min.js",
    "jbf/workbench/vendored_files/uPlot.LICENSE",
    ".dist-info/licenses/LICENSE-MIT",
    ".dist-info/licenses/LICENSE-APACHE",
    ".dist-info/licenses/THIRD_PARTY.md",
)


def find_wheel(place: Path) -> Path:
    """Return the path of a wheel, given itself or as the only one in a folder."""
    wheels = sorted(place.glob("*.whl")) if place.is_dir() else [place]
    if len(wheels) != 1 or not wheels[0].is_file():
        sys.exit(f"{place} is neither a wheel nor a folder of one")
    return wheels[0].resolve()


def check_contents(wheel: Path) -> None:
    """Check that a wheel contains the required files and no others."""
    with zipfile.ZipFile(wheel) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    for wanted in MUST_HOLD:
        if not any(wanted in name for name in contents):
            sys.exit(f"{wheel.name} lacks {wanted}")
    if strays := [n for n in contents if "tests/" in n or n.endswith((".pyc", ".rs"))]:
        sys.exit(f"{wheel.name} holds {strays[0]}, which is not for users")
    for name, content in contents.items():
        for place in (str(Path.home()), str(ROOT), BUILD_FOLDER):
            if os.fsencode(place) in content:
                sys.exit(f"{name} names {place}..., a folder of the machine that built it")


def first_diagnosis(python: Path, wheel: Path, folder: Path) -> None:
    """Install the wheel and run a diagnosis; exit if it fails or imports another jbf."""
    start, before = time.monotonic(), os.times()
    install = [python, "-m", "pip", "install", "--quiet", "--only-binary", ":all:", wheel]
    run(install, cwd=folder)
    installed = time.monotonic()
    jbf = python.with_name("jbf.exe" if os.name == "nt" else "jbf")
    run([jbf, "--version"], cwd=folder)
    where = run(
        [python, "-c", "import jbf, jbf._core; print(jbf.__file__); print(jbf._core.__file__)"],
        cwd=folder,
    )
    inside = python.parents[1].resolve()
    for line in where.split():
        if not (Path(line).resolve().is_relative_to(inside) and "site-packages" in line):
            sys.exit(f"jbf comes from {line}, not from the wheel")
    data, found = folder / "jbf-demo", folder / "found.json"
    run([jbf, "demo", data], cwd=folder, quiet=True)
    took, after = time.monotonic(), os.times()
    spent = after.children_user + after.children_system
    spent -= before.children_user + before.children_system
    say(
        f"pip install {installed - start:.0f} s, jbf demo {took - installed:.0f} s, "
        f"{spent:.0f} s of the processor for both"
    )
    # Repeat the diagnosis from files, as for a user's rig.
    own = data / "hidden"
    run([jbf, "diagnose", own / "rig.toml", own, "--json", found], cwd=folder, quiet=True)
    answer = json.loads(found.read_text(encoding="utf-8"))
    if (answer["verdict"], set(answer["effects"])) != ("missing", {"coulomb_drag", "sensor_lag"}):
        sys.exit(f"the diagnosis says {answer['verdict']} {answer['effects']}")


def run_tests(python: Path, folder: Path, tests: list[str]) -> None:
    """Run the tests against the installed package."""
    tree = folder / "tree"
    for name in tracked_files():
        if name.as_posix().startswith(COPIED):
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, tree / name)
    files = [f"python/tests/{name}.py" for name in tests] or ["python/tests"]
    run([python, "-m", "pytest", *files], cwd=tree)


def main() -> None:
    """Test the wheel for the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path, help="a wheel, or the folder of one")
    parser.add_argument("--python", default=sys.executable, help="another interpreter to test with")
    parser.add_argument("--tests", nargs="*", default=list(TESTS), help="of python/tests")
    chosen = parser.parse_args()
    wheel = find_wheel(chosen.wheel)
    check_contents(wheel)
    with tempfile.TemporaryDirectory(prefix="jbf-wheel-") as name:
        folder = Path(name)
        say(f"{wheel.name} in a new environment")
        python = make_environment(folder / "environment", chosen.python)
        first_diagnosis(python, wheel, folder)
        run([python, "-m", "pip", "install", "--quiet", *TOOLS], cwd=folder)
        run_tests(python, folder, chosen.tests)
    say(f"{wheel.name} passed")


if __name__ == "__main__":
    main()
