"""Every program of `benches` starts as its README says."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

BENCHES = Path(__file__).parents[2] / "benches"
PROGRAMS = sorted(
    path
    for path in (*BENCHES.glob("*.py"), *BENCHES.glob("*/__main__.py"))
    if '__name__ == "__main__"' in path.read_text(encoding="utf-8")
)


def test_there_are_programs() -> None:
    assert {"drives.py", "control_runs.py"} <= {path.name for path in PROGRAMS}
    assert len(PROGRAMS) > 15


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.relative_to(BENCHES).as_posix())
def test_a_program_says_what_it_does(path: Path) -> None:
    program = path.parent if path.name == "__main__.py" else path
    asked = [sys.executable, str(program), "--help"]
    said = subprocess.run(asked, capture_output=True, text=True, timeout=120, check=False)
    assert said.returncode == 0, said.stderr
    assert said.stdout.startswith("usage: ")
