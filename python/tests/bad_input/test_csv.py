"""What may stand in a CSV file: one line names file, row and column, or the number comes out."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import pytest
from bad_input.checking import (
    HEADER,
    RMS_N,
    ROWS,
    Capture,
    changed,
    compared,
    refused,
    table,
    with_cell,
)

GOOD = table()
LINES = GOOD.splitlines()
UNITS = "\n".join([LINES[0], "s,m/s,N", *LINES[1:]])
EMPTY_COLUMN = table([(*r, "") for r in ROWS], (*HEADER, "load_n"))
T = [float(r[0]) for r in ROWS]


def left(factor: float) -> float:
    """RMS, N, that the model leaves of the friction taken so many times."""
    pairs = [(5.0 + 20.0 * float(v), float(f)) for _, v, f in ROWS]
    return math.sqrt(sum((factor * f - told) ** 2 for told, f in pairs) / len(pairs))


def moved(time_s: list[float]) -> str:
    """The run with other instants."""
    return table([(repr(t), *r[1:]) for t, r in zip(time_s, ROWS, strict=True)])


REFUSED: dict[str, tuple[str | bytes, str]] = {
    # Encodings
    "utf-16 with mark": (GOOD.encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    "utf-16 little": (GOOD.encode("utf-16-le"), "is binary, not text"),
    "utf-16 big": (GOOD.encode("utf-16-be"), "is binary, not text"),
    "utf-32": (GOOD.encode("utf-32"), "UTF-16 text; save it as UTF-8"),
    "latin-1": (GOOD.replace("friction_n", "friction_n,µ").encode("latin-1"), "is not UTF-8"),
    "latin-1 in a cell": (("#\n" + with_cell(9, "friction_n", "5°")).encode("latin-1"), "row 10"),
    "broken utf-8": (GOOD.encode() + b"1.2,0.1,\xc3\n", "row 62: is not UTF-8"),
    # Not text
    "gzip": (gzip.compress(GOOD.encode(), mtime=0), "is compressed (gzip), not text; unpack it"),
    "a zip, as Excel writes": (b"PK\x03\x04\x14\x00" + bytes(40), "jbf import reads spreadsheets"),
    "a NUL": (with_cell(9, "friction_n", "5\0"), "is binary, not text; name a text file"),
    "a NUL in the header": ("\0" + GOOD, "is binary, not text"),
    "zeros": (bytes(4096), "is binary, not text"),
    "a picture": (b"\x89PNG\r\n\x1a\n" + bytes(100), "is binary, not text"),
    "markup": ("<html><body>Not found</body></html>\n", "row 1: the names are parted by blanks"),
    "json": ('{"time_s": [1, 2]}\n', "is missing"),
    # Shapes
    "empty": ("", "is empty; start with a header"),
    "blank lines": ("\n\n  \n", "is empty; start with a header"),
    "comments alone": ("# a\n# b\n", "is empty; start with a header"),
    "a mark alone": (b"\xef\xbb\xbf", "is empty; start with a header"),
    "header alone": (LINES[0], "has a header but no samples; add the samples"),
    "header and break": (LINES[0] + "\r\n", "has a header but no samples"),
    "one row": ("\n".join(LINES[:2]), "has 1 sample; a run needs at least 10"),
    "nine rows": ("\n".join(LINES[:10]), "has 9 samples; a run needs at least 10"),
    "no header": ("\n".join(LINES[1:]), "row 1: holds numbers where the header should be"),
    "header behind #": ("#" + GOOD, "row 2: holds numbers where the header should be"),
    "header in the midst": ("\n".join([*LINES, *LINES]), "row 62, column time_s"),
    "a row of units": (UNITS, 'row 2, column time_s: "s" is not a number'),
    "a total at the end": (GOOD + "sum,,300\n", 'row 62, column time_s: "sum" is not a number'),
    "a title": ("Run of 3 May\n" + GOOD, "row 1: the names are parted by blanks"),
    "a short row": (GOOD + "1.2,0.1\n", "row 62: has 2 cells where the header has 3"),
    "a long row": (GOOD + "1.2,0.1,5,6\n", "row 62: has 4 cells where the header has 3"),
    "cut off": (GOOD[: GOOD.rindex(",")], "row 61: has 2 cells where the header has 3"),
    "blanks": (GOOD.replace(",", " "), "row 1: the names are parted by blanks"),
    "bars": (GOOD.replace(",", "|"), "row 1, column time_s: is missing"),
    "open quote": ('time_s,"velocity_m_s,friction_n\n1,2,3\n', "row 1: a quote is not closed"),
    "a quote in a cell": (with_cell(9, "friction_n", '"5'), "row 9: a quote is not closed"),
    "a cell of 200 kB": (with_cell(9, "friction_n", "5" * 200_000), "row 9: field larger than"),
    "a cell of 1 kB": (with_cell(9, "friction_n", "x" * 1000), 'friction_n: "xxxxxxxxxx'),
    # Headers
    "time missing": (GOOD.replace("time_s", "when"), "row 1, column time_s: is missing; add it"),
    "friction missing": (GOOD.replace("friction_n", "f"), "column friction_n: is missing"),
    "motion missing": (GOOD.replace("velocity_m_s", "u"), "column velocity_m_s: is missing"),
    "misspelt": (GOOD.replace("friction", "fricton"), 'did you mean "fricton_n"? rename it'),
    "capitals": (GOOD.replace("time_s", "Time_S"), 'did you mean "Time_S"? rename it'),
    "a unit in the name": (GOOD.replace("time_s", "time_ms"), 'did you mean "time_ms"?'),
    "of a drive": (GOOD.replace("friction_n", "torque_n_m"), "a rig with [drive] tells what"),
    "twice": (GOOD.replace("velocity_m_s", "time_s"), "column time_s: stands twice in the header"),
    "a header of blanks": (" , , \n1,2,3\n", "column time_s: is missing"),
    # Cells
    "text": (with_cell(9, "friction_n", "abc"), 'row 9, column friction_n: "abc" is not a number'),
    "a dash": (with_cell(9, "friction_n", "-"), 'row 9, column friction_n: "-" is not a number'),
    "n/a": (with_cell(9, "velocity_m_s", "#N/A"), 'column velocity_m_s: "#N/A" is not a number'),
    "a formula": (with_cell(9, "friction_n", "=A1*2"), '"=A1*2" is not a number'),
    "a unit": (with_cell(9, "friction_n", "5 N"), 'row 9, column friction_n: "5 N"'),
    "hexadecimal": (with_cell(9, "friction_n", "0x1F"), '"0x1F" is not a number'),
    "two points": (with_cell(9, "friction_n", "1.234.5"), '"1.234.5" is not a number'),
    "a clock": (with_cell(9, "time_s", "12:00:01"), 'column time_s: "12:00:01" is not a number'),
    "escapes": (with_cell(9, "friction_n", "\x1b[31m"), "\\x1b[31m"),
    "empty cell": (
        with_cell(9, "friction_n", ""),
        "row 9, column friction_n: the cell is empty; fill",
    ),
    "blank": (with_cell(9, "velocity_m_s", "  "), "row 9, column velocity_m_s: the cell is empty"),
    "no time": (with_cell(9, "time_s", ""), "row 9, column time_s: the cell is empty"),
    "empty column": (EMPTY_COLUMN, "row 2, column load_n: the cell is empty"),
    "nan": (with_cell(9, "friction_n", "NaN"), "row 9, column friction_n: nan is not a finite"),
    "nan in time": (with_cell(9, "time_s", "nan"), "row 9, column time_s: nan is not a finite"),
    "inf": (with_cell(9, "friction_n", "inf"), "row 9, column friction_n: inf is not a finite"),
    "minus inf": (with_cell(9, "velocity_m_s", "-Infinity"), "-inf is not a finite number"),
    "1e400": (with_cell(9, "friction_n", "1e400"), "row 9, column friction_n: inf is not"),
    "decimal comma": (
        table([(r[0], r[1], r[2].replace(".", ",")) for r in ROWS], sep=";"),
        'row 2, column friction_n: "7,500000" has a decimal comma',
    ),
    "all commas": (GOOD.replace(".", ","), "row 2: has 6 cells where the header has 3"),
    # Times
    "unsorted": (table([ROWS[1], ROWS[0], *ROWS[2:]]), "row 3, column time_s: time runs back"),
    "backwards": (table(ROWS[::-1]), "row 3, column time_s: time runs back from 1.18 to 1.16"),
    "repeated": (table([*ROWS[:5], *ROWS[4:]]), "row 7, column time_s: time repeats at 0.08"),
    "two runs": (table([*ROWS, *ROWS]), "row 62, column time_s: time runs back from 1.18 to 0.0"),
    "one instant": (changed("time_s", lambda _: 1.0), "row 3, column time_s: time repeats at 1.0"),
    "instants lost": (changed("time_s", lambda t: t + 1e17), "column time_s"),
    # Sizes that no machine has
    "1e160 N": (with_cell(9, "friction_n", "1e160"), "row 9, column friction_n: 1e+160"),
    "1e308 N": (with_cell(9, "friction_n", "1e308"), "row 9, column friction_n: 1e+308"),
    "-1e308 N": (with_cell(9, "friction_n", "-1e308"), "row 9, column friction_n: -1e+308"),
    "1e200 N all over": (changed("friction_n", lambda f: 1e200 * f), "row 2, column friction_n"),
    "1e160 m/s": (with_cell(9, "velocity_m_s", "1e160"), "row 9, column velocity_m_s: 1e+160"),
    "1e308 m/s": (with_cell(9, "velocity_m_s", "-1e308"), "row 9, column velocity_m_s: -1e+308"),
    "1e160 s": (with_cell(61, "time_s", "1e160"), "row 61, column time_s: 1e+160"),
    "1e308 s": (with_cell(61, "time_s", "1e308"), "row 61, column time_s: 1e+308"),
    "1e300 s all over": (changed("time_s", lambda t: 1e300 * t), "column time_s"),
    "nanoseconds of an epoch": (changed("time_s", lambda t: 1.7e18 + 1e9 * t), "column time_s"),
    "instants of 1e-320 s": (changed("time_s", lambda t: 1e-320 * t), "column time_s"),
    # Loads
    "no load": (table([(*r, "0") for r in ROWS], (*HEADER, "load_n")), "a load of 0.0 N"),
    "load below zero": (table([(*r, "-3") for r in ROWS], (*HEADER, "load_n")), "load of -3.0 N"),
    "load of 1e300": (table([(*r, "1e300") for r in ROWS], (*HEADER, "load_n")), "column load_n"),
    "hot": (table([(*r, "1e200") for r in ROWS], (*HEADER, "temperature_c")), "temperature_c"),
}

MEANT: dict[str, tuple[str | bytes, float]] = {
    "as it is": (GOOD, RMS_N),
    "a mark first": (b"\xef\xbb\xbf" + GOOD.encode(), RMS_N),
    "crlf": (GOOD.replace("\n", "\r\n"), RMS_N),
    "cr alone": (GOOD.replace("\n", "\r"), RMS_N),
    "mixed breaks": (GOOD.replace("\n", "\r\n", 7), RMS_N),
    "no last break": (GOOD.rstrip("\n"), RMS_N),
    "semicolons": (GOOD.replace(",", ";"), RMS_N),
    "tabs": (GOOD.replace(",", "\t"), RMS_N),
    "quoted": (GOOD.replace(LINES[0], ",".join(f'"{c}"' for c in HEADER)), RMS_N),
    "every cell quoted": (
        "\n".join(",".join(f'"{c}"' for c in li.split(",")) for li in LINES),
        RMS_N,
    ),
    "blanks round cells": (GOOD.replace(",", " , "), RMS_N),
    "blank lines": (GOOD.replace("\n", "\n\n"), RMS_N),
    "comments first": ("# of 3 May, µm\n\n#\n" + GOOD, RMS_N),
    "columns turned": (table([r[::-1] for r in ROWS], HEADER[::-1]), RMS_N),
    "a comment column": (table([(*r, "good") for r in ROWS], (*HEADER, "remark")), RMS_N),
    "an empty name": (table([(*r, "") for r in ROWS], (*HEADER, "")), RMS_N),
    "a broken extra": (table([(*r, "nan") for r in ROWS], (*HEADER, "current")), RMS_N),
    "huge extra": (table([(*r, "1e308") for r in ROWS], (*HEADER, "current")), RMS_N),
    "names of Latin-1 in UTF-8": (table([(*r, "1") for r in ROWS], (*HEADER, "µ_°")), RMS_N),
    "exponents": (changed("time_s", lambda t: t).replace("0.02,", "2.0E-02,"), RMS_N),
    "plus signs": (GOOD.replace(",", ",+").replace(",+v", ",v").replace(",+f", ",f"), RMS_N),
    "later start": (changed("time_s", lambda t: t + 1e6), RMS_N),
    "before zero": (changed("time_s", lambda t: t - 5.0), RMS_N),
    "epoch": (changed("time_s", lambda t: 1.7e9 + t), RMS_N),
    "milliseconds": (changed("time_s", lambda t: 1e3 * t), RMS_N),
    "microseconds": (changed("time_s", lambda t: 1e6 * t), RMS_N),
    "uneven instants": (moved([t + 0.009 * (i % 2) for i, t in enumerate(T)]), RMS_N),
    "a gap": (moved([t + (50.0 if t > 0.5 else 0.0) for t in T]), RMS_N),
    "ten rows": ("\n".join(LINES[:11]), RMS_N),
    "kilonewtons": (changed("friction_n", lambda f: 1e-3 * f), left(1e-3)),
    "millinewtons": (changed("friction_n", lambda f: 1e3 * f), left(1e3)),
    "1e9 N": (changed("friction_n", lambda f: 1e9 * f), left(1e9)),
    "friction turned": (changed("friction_n", lambda f: -f), left(-1.0)),
    "friction of 1e-300": (changed("friction_n", lambda f: 1e-300 * f), left(0.0)),
    "turned": (table([(r[0], "-" + r[1], repr(-float(r[2]))) for r in ROWS]), RMS_N),
}


def write(content: str | bytes) -> None:
    data = content if isinstance(content, bytes) else content.encode()
    Path("bad.csv").write_bytes(data)


@pytest.mark.parametrize("name", REFUSED)
def test_one_line_names_the_place(name: str, capfd: Capture) -> None:
    content, fragment = REFUSED[name]
    write(content)
    assert refused(["compare", "model.toml", "bad.csv"], fragment, capfd).startswith("jbf: bad.csv")


@pytest.mark.parametrize("name", MEANT)
def test_the_number_comes_out(name: str, capfd: Capture) -> None:
    content, rms_n = MEANT[name]
    write(content)
    assert compared("bad.csv", capfd)["rms_n"] == pytest.approx(rms_n, rel=5e-3)
