"""A minimal campaign and the checks that every bad or unusual input must pass.

The campaign is so small that a comparison takes milliseconds. Its residual alternates between plus
and minus half a newton, so that its RMS is 0.5 N: an input that is accepted must reproduce this
number. An input that is refused must end with exit code 2 and one line on standard error, and must
leave every file as it was.
"""

import json
import math
import os
import re
import signal
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from jbf.cli import main
from jbf.errors import InputError

Capture = pytest.CaptureFixture[str]
Text = str | bytes

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
F_c = {value = 5.0, stderr = 0.1}
F_v = {value = 20.0, stderr = 1.0}
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
FILM_WARNING = "jbf: the film of this model responds at "
SIZE_WARNING = re.compile("jbf: [a-z_.]+: [^ ]+ [^;]* is outside the usual ")
SECONDS = 20
"""Time limit of one command; far longer than any of them takes."""


def cases(rows: Mapping[str, tuple[Any, ...]], fast: Collection[str]) -> list[Any]:
    """Parameters of a test, one set per row; rows not in `fast` run in the extended suite."""
    assert set(fast) <= set(rows)
    return [
        pytest.param(*row, id=name, marks=() if name in fast else pytest.mark.extended)
        for name, row in rows.items()
    ]


def csv_text(
    rows: Sequence[Sequence[str]] = ROWS, header: Sequence[str] = HEADER, sep: str = ","
) -> str:
    """The CSV text of a run."""
    return "".join(sep.join(cells) + "\n" for cells in (header, *rows))


def with_cell(row: int, column: str, text: str) -> str:
    """The run with a different text in one cell; the header is row 1."""
    rows = [list(cells) for cells in ROWS]
    rows[row - 2][HEADER.index(column)] = text
    return csv_text(rows)


def with_column(column: str, change: Callable[[float], float]) -> str:
    """The run with a function applied to every value of a column."""
    index = HEADER.index(column)
    return csv_text([[*r[:index], repr(change(float(r[index]))), *r[index + 1 :]] for r in ROWS])


def write(content: Text, name: str = "bad.toml") -> None:
    """Write a text or bytes to a file in the working folder."""
    Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())


def campaign(folder: Path) -> Path:
    """Write rig.toml, model.toml, map.toml and one run, a.csv."""
    (folder / "rig.toml").write_text(RIG)
    (folder / "model.toml").write_text(MODEL)
    (folder / "map.toml").write_text(MAP)
    (folder / "a.csv").write_text(csv_text())
    return folder


@contextmanager
def in_time(seconds: float = SECONDS) -> Iterator[None]:
    """Fail when the enclosed block takes longer than the time limit."""

    def timeout(*_: object) -> None:
        raise AssertionError(f"took longer than {seconds} s")

    before = signal.signal(signal.SIGALRM, timeout)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _files() -> dict[str, bytes]:
    """Content of every readable regular file below the working folder."""
    contents = {}
    for folder, _, names in os.walk("."):
        for name in names:
            path = Path(folder) / name
            if path.is_file() and not path.is_symlink():
                with suppress(PermissionError):
                    contents[str(path)] = path.read_bytes()
    return contents


def refused(arguments: Sequence[str], fragment: str, capture: Capture) -> str:
    """Check that a command is refused in one line without changing a file; return the line."""
    before = _files()
    capture.readouterr()
    with in_time():
        assert main([str(a) for a in arguments]) == 2
    printed = capture.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("jbf: ")
    assert printed.err.endswith("\n")
    assert printed.err.count("\n") == 1
    assert fragment in printed.err
    assert "Traceback" not in printed.err
    assert _files() == before
    return printed.err.strip()


def accepted(arguments: Sequence[str], capture: Capture) -> str:
    """Check that a command succeeds without NaN in its output; return what it prints."""
    capture.readouterr()
    with in_time():
        assert main([str(a) for a in arguments]) == 0
    printed = capture.readouterr()
    for line in printed.err.splitlines():
        assert line.startswith(FILM_WARNING) or SIZE_WARNING.match(line), line
    assert " nan" not in printed.out.lower()
    return printed.out


def compared(run: str, capture: Capture, model: str = "model.toml") -> dict[str, Any]:
    """The JSON result of `jbf compare`."""
    result: dict[str, Any] = json.loads(accepted(["compare", model, run, "--json", "-"], capture))
    return result


def raises_one_line(call: Callable[[], Any], fragment: str) -> None:
    """Check that a call raises an `InputError` of one line."""
    with in_time(), pytest.raises(InputError) as caught:
        call()
    assert fragment in str(caught.value)
    assert "\n" not in str(caught.value)
