"""Every program of `benches` starts and describes its options."""

import subprocess
import sys
from pathlib import Path

import pytest
from input_checks import cases

BENCHES = Path(__file__).parents[3] / "benches"
PROGRAMS = sorted(
    path
    for path in (*BENCHES.glob("*.py"), *BENCHES.glob("*/__main__.py"))
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
)
FAST = ("recovery.py",)


def name_of(path: Path) -> str:
    return path.relative_to(BENCHES).as_posix()


def test_list_of_bench_programs_includes_known_programs() -> None:
    assert {"drives.py", "control_runs.py", *FAST} <= {name_of(path) for path in PROGRAMS}


@pytest.mark.parametrize("path", cases({name_of(p): (p,) for p in PROGRAMS}, FAST))
def test_bench_program_prints_its_usage_with_the_help_option(path: Path) -> None:
    program = path.parent if path.name == "__main__.py" else path
    command = [sys.executable, str(program), "--help"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: ")
