"""What every bad or odd input is held to: one clear line, or the number that it means.

A campaign so small that a comparison takes milliseconds, and whose every number is known: under the
model the residual is plus and minus half a newton by turns, so its RMS is 0.5 N.
"""

from __future__ import annotations

import json
import math
import os
import signal
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from jbf.cli import main
from jbf.errors import InputError

Capture = pytest.CaptureFixture[str]

RMS_N = 0.5
SAMPLES = 60
HEADER = ("time_s", "velocity_m_s", "friction_n")
ROWS = tuple(
    (
        f"{0.02 * i:.2f}",
        f"{0.1 + 0.05 * math.sin(0.3 * i):.6f}",
        f"{5.0 + 20.0 * round(0.1 + 0.05 * math.sin(0.3 * i), 6) + RMS_N * (-1) ** i:.6f}",
    )
    for i in range(SAMPLES)
)
MODEL = """\
format = 1
law = "coulomb"
clock = "journal"
effects = []
[parameters]
F_c_n = {value = 5.0, stderr = 0.1}
F_v_n_s_m = {value = 20.0, stderr = 1.0}
"""
RIG = """\
[bearing]
radius_m = 0.0127
length_m = 0.0254
clearance_m = 2.5e-5
mass_kg = 2.27
count = 4

[lubricant]
viscosity_pa_s = 0.002

[load]
normal_n = 104.0
"""
MAP = """\
[columns]
time_s = "time_s"
velocity_m_s = "velocity_m_s"
friction_n = "friction_n"
[drive]
motion = "linear"
friction = "force"
"""
FILM = "jbf: the film of this model answers at "
SECONDS = 20
"""Longer than any input here takes, even on a machine that does much else."""


def table(
    rows: Sequence[Sequence[str]] = ROWS, header: Sequence[str] = HEADER, sep: str = ","
) -> str:
    """A run as text."""
    return "".join(sep.join(cells) + "\n" for cells in (header, *rows))


def with_cell(row: int, column: str, text: str) -> str:
    """A run with one cell changed; the header is row 1."""
    rows = [list(cells) for cells in ROWS]
    rows[row - 2][HEADER.index(column)] = text
    return table(rows)


def changed(column: str, change: Callable[[float], float]) -> str:
    """A run with every cell of a column changed."""
    at = HEADER.index(column)
    return table([[*r[:at], repr(change(float(r[at]))), *r[at + 1 :]] for r in ROWS])


def campaign(folder: Path) -> Path:
    """rig.toml, model.toml, map.toml and one run, a.csv."""
    (folder / "rig.toml").write_text(RIG)
    (folder / "model.toml").write_text(MODEL)
    (folder / "map.toml").write_text(MAP)
    (folder / "a.csv").write_text(table())
    return folder


@contextmanager
def in_time(seconds: float = SECONDS) -> Iterator[None]:
    """A failure where what is inside takes for ever."""

    def late(*_: object) -> None:
        raise AssertionError(f"no end within {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _files() -> dict[str, bytes]:
    """Every plain file below the working folder that can be read."""
    found = {}
    for folder, _, names in os.walk("."):
        for name in names:
            path = Path(folder) / name
            if path.is_file() and not path.is_symlink():
                with suppress(PermissionError):
                    found[str(path)] = path.read_bytes()
    return found


def refused(arguments: Sequence[str], fragment: str, capture: Capture) -> str:
    """The one line that a command is refused with; exit 2, and every file as it was."""
    before = _files()
    capture.readouterr()
    with in_time():
        assert main([str(a) for a in arguments]) == 2
    said = capture.readouterr()
    assert said.out == ""
    assert said.err.startswith("jbf: ")
    assert said.err.endswith("\n")
    assert said.err.count("\n") == 1
    assert fragment in said.err
    assert "Traceback" not in said.err
    assert _files() == before
    return said.err.strip()


def accepted(arguments: Sequence[str], capture: Capture) -> str:
    """What a command prints; exit 0, and nothing on stderr but what is said of a fast film."""
    capture.readouterr()
    with in_time():
        assert main([str(a) for a in arguments]) == 0
    said = capture.readouterr()
    assert [line for line in said.err.splitlines() if not line.startswith(FILM)] == []
    assert " nan" not in said.out.lower()
    return said.out


def compared(run: str, capture: Capture, model: str = "model.toml") -> dict[str, Any]:
    """The JSON of a comparison."""
    found: dict[str, Any] = json.loads(accepted(["compare", model, run, "--json", "-"], capture))
    return found


def one_line(call: Callable[[], Any], fragment: str) -> None:
    """A call that ends as an `InputError` of one line."""
    with in_time(), pytest.raises(InputError) as caught:
        call()
    assert fragment in str(caught.value)
    assert "\n" not in str(caught.value)
