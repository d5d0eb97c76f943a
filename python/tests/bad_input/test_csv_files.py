"""CSV files: invalid content is refused with its position; unusual notation is read correctly."""

import gzip
import math

import pytest
from input_checks import (
    HEADER,
    RMS_N,
    ROWS,
    Capture,
    compared,
    csv_text,
    refused,
    with_cell,
    with_column,
    write,
)

Text = str | bytes
GOOD = csv_text()
LINES = GOOD.splitlines()
COMMAS = csv_text([(t, v, f.replace(".", ",")) for t, v, f in ROWS], sep=";")


def with_force(text: str) -> str:
    """The run with another text for the force in row 9."""
    return with_cell(9, "friction_n", text)


def rms_of_scaled(factor: float) -> float:
    """RMS (N) of the residual when the recorded friction is multiplied by a factor."""
    pairs = [(5.0 + 20.0 * float(v), float(f)) for _, v, f in ROWS]
    return math.sqrt(sum((factor * f - model) ** 2 for model, f in pairs) / len(pairs))


REFUSED: dict[str, tuple[Text, str]] = {
    # Encodings
    "utf-16 with mark": (GOOD.encode("utf-16"), "is UTF-16 text; save it as UTF-8"),
    "latin-1": (GOOD.replace("friction_n", "friction_n,µ").encode("latin-1"), "is not UTF-8"),
    # Not text
    "gzip": (gzip.compress(GOOD.encode(), mtime=0), "is compressed (gzip), not text; unpack it"),
    "a NUL": (with_force("5\0"), "is binary, not text; name a text file"),
    # Shapes
    "empty": ("", "is empty; start with a header"),
    "header without samples": (LINES[0], "has a header but no samples; add the samples"),
    "nine rows": ("\n".join(LINES[:10]), "has 9 samples; a run needs at least 10"),
    "no header": ("\n".join(LINES[1:]), "row 1: has numbers where the header should be"),
    "a short row": (GOOD + "1.2,0.1\n", "row 62: has 2 cells where the header has 3"),
    "a quote in a cell": (with_force('"5'), "row 9: a quotation mark is not closed"),
    # Headers
    "time missing": (GOOD.replace("time_s", "when"), "row 1, column time_s: is missing; add it"),
    "a unit in the name": (GOOD.replace("time_s", "time_ms"), 'did you mean "time_ms"?'),
    "twice": (GOOD.replace("velocity_m", "time"), "column time_s: is in the header twice"),
    # Cells
    "text": (with_force("abc"), 'row 9, column friction_n: "abc" is not a number'),
    "escapes": (with_force("\x1b[31m"), "\\x1b[31m"),
    "empty cell": (with_force(""), "row 9, column friction_n: the cell is empty; fill"),
    "nan": (with_force("NaN"), "row 9, column friction_n: nan is not a finite"),
    "1e400": (with_force("1e400"), "row 9, column friction_n: inf is not"),
    "decimal comma": (COMMAS, 'row 2, column friction_n: "7,500000" has a decimal comma'),
    # Times
    "unsorted": (csv_text([ROWS[1], ROWS[0], *ROWS[2:]]), "row 3, column time_s: time decreases"),
    "repeated": (csv_text([*ROWS[:5], *ROWS[4:]]), "row 7, column time_s: time repeats at 0.08"),
    # Sizes beyond those of any machine
    "1e160 N": (with_force("1e160"), "row 9, column friction_n: 1e+160"),
    "nanoseconds of an epoch": (with_column("time_s", lambda t: 1.7e18 + 1e9 * t), "column time_s"),
    # Loads
    "no load": (csv_text([(*r, "0") for r in ROWS], (*HEADER, "load_n")), "a load of 0.0 N"),
}

ACCEPTED: dict[str, tuple[Text, float]] = {
    "unchanged": (GOOD, RMS_N),
    "byte-order mark first": (b"\xef\xbb\xbf" + GOOD.encode(), RMS_N),
    "crlf": (GOOD.replace("\n", "\r\n"), RMS_N),
    "cr alone": (GOOD.replace("\n", "\r"), RMS_N),
    "semicolons": (GOOD.replace(",", ";"), RMS_N),
    "tabs": (GOOD.replace(",", "\t"), RMS_N),
    "quoted": (GOOD.replace(LINES[0], ",".join(f'"{c}"' for c in HEADER)), RMS_N),
    "blanks round cells": (GOOD.replace(",", " , "), RMS_N),
    "blank lines": (GOOD.replace("\n", "\n\n"), RMS_N),
    "columns in reverse order": (csv_text([r[::-1] for r in ROWS], HEADER[::-1]), RMS_N),
    "a comment column": (csv_text([(*r, "good") for r in ROWS], (*HEADER, "remark")), RMS_N),
    "exponents": (with_column("time_s", lambda t: t).replace("0.02,", "2.0E-02,"), RMS_N),
    "epoch": (with_column("time_s", lambda t: 1.7e9 + t), RMS_N),
    "milliseconds": (with_column("time_s", lambda t: 1e3 * t), RMS_N),
    "ten rows": ("\n".join(LINES[:11]), RMS_N),
    "friction negated": (with_column("friction_n", lambda f: -f), rms_of_scaled(-1.0)),
    "friction of 1e-300": (with_column("friction_n", lambda f: 1e-300 * f), rms_of_scaled(0.0)),
    "both negated": (csv_text([(t, f"-{v}", repr(-float(f))) for t, v, f in ROWS]), RMS_N),
}


@pytest.mark.parametrize(("content", "fragment"), REFUSED.values(), ids=REFUSED)
def test_invalid_csv_is_refused_with_file_and_cause(
    content: Text, fragment: str, capfd: Capture
) -> None:
    write(content, "bad.csv")
    assert refused(["compare", "model.toml", "bad.csv"], fragment, capfd).startswith("jbf: bad.csv")


@pytest.mark.parametrize(("content", "rms"), ACCEPTED.values(), ids=ACCEPTED)
def test_csv_in_unusual_notation_is_read_with_the_expected_rms(
    content: Text, rms: float, capfd: Capture
) -> None:
    write(content, "bad.csv")
    assert compared("bad.csv", capfd)["rms"] == pytest.approx(rms, rel=5e-3)
