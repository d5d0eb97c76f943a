"""Compare the parsers of `jbf import` with libraries: units, dates and text dialects.

`python benches/import_libraries.py` prints Markdown tables. A reading is right, refused (an error
or no result) or wrong (another value without an error). A library that is not installed is skipped:
`pip install pint python-dateutil clevercsv pandas polars duckdb`.
"""

from __future__ import annotations

import argparse
import csv
import importlib
import io
import math
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable, Iterable, Mapping
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from import_cases import (
    DATES,
    NO_DATES,
    ORDERS,
    PINT_DEFINITIONS,
    PINT_REWRITES,
    TWO_MEANINGS,
    UNITS,
    Text,
    texts,
)  # fmt: skip

Outcome = str | None
"""Result of a parser: an empty text if it is right, the wrong value as text, None if it refuses."""


def library(name: str) -> Any:
    """Import a module and return it; return None and print a message if it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{name} is not installed; skipped", file=sys.stderr)
        return None


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """Print a Markdown table."""
    head = list(head)
    print("\n|", " | ".join(head), "|")
    print("|", " | ".join("---" for _ in head), "|")
    for row in rows:
        print("|", " | ".join(str(cell) for cell in row), "|")


def counted(outcomes: Mapping[str, Outcome]) -> list[object]:
    """Return the numbers of right, refused and wrong results, and the wrong results."""
    wrong = {text: shown for text, shown in outcomes.items() if shown}
    refused = [f"`{text}`" for text, shown in outcomes.items() if shown is None]
    listed = "; ".join(f"`{text}`: {shown}" for text, shown in wrong.items())
    few = f"{len(refused)} ({', '.join(refused)})" if 0 < len(refused) < 5 else len(refused)
    return [len(outcomes) - len(refused) - len(wrong), few, len(wrong), listed or "none"]


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def import_seconds(code: str, times: int = 5) -> float:
    """Return the median time of a new process that runs the code, without numpy's import, s."""

    def took(line: str) -> float:
        return seconds(lambda: subprocess.run([sys.executable, "-c", line], check=True))

    pairs = [(took(f"import numpy; {code}"), took("import numpy")) for _ in range(times + 1)]
    return median(a - b for a, b in pairs[1:])


# Units


def own_unit(text: str) -> tuple[float, dict[str, int]] | None:
    from jbf.units.table import BASES
    from jbf.units.unit import parse_unit

    unit = parse_unit(text)
    if unit is None:
        return None
    return unit.in_si, dict(zip(BASES, unit.dimensions, strict=True))


_PINT_BASES = {
    "[mass]": "kg", "[length]": "m", "[time]": "s", "[current]": "A", "[temperature]": "K",
    "[angle]": "rad", "[counts]": "count", "[substance]": "mol",
}  # fmt: skip


def pint_unit(registry: Any, text: str) -> tuple[float, dict[str, int]] | None:
    try:
        for rewrite in registry.preprocessors:
            text = rewrite(text)
        unit = registry.Unit(registry.parse_units(text))
        interval = text.replace("°", "deg")
        interval = f"delta_{interval}" if interval in ("degC", "degF") else unit
        size = (1.0 * registry.Unit(interval)).to_base_units()
    except Exception:
        return None
    powers = {_PINT_BASES.get(k, k): v for k, v in size.dimensionality.items()}
    return float(size.magnitude), {k: int(v) for k, v in powers.items()}


def unit_outcome(reading: tuple[float, dict[str, int]] | None, wanted: str, size: float) -> Outcome:
    """Assess the parsed size and dimensions of a unit.

    Angles and counts may be dimensionless; degrees that are parsed as radians are wrong.
    """
    if reading is None:
        return None
    expected = {b: int(p or 1) for b, _, p in (f.partition("^") for f in wanted.split())}
    powers = {base: power for base, power in reading[1].items() if power}
    counts = {"rad": 0, "count": 0}
    same = {**powers, **counts} == {**expected, **counts} and set(powers) <= set(expected)
    if same and math.isclose(reading[0], size, rel_tol=1e-9):
        return ""
    return f"{reading[0]:.6g} {' '.join(f'{b}^{p}' for b, p in powers.items()) or '1'}"


def compare_units() -> None:
    """Compare the unit parsers of several libraries: results, import time and rounding."""
    from jbf.units.table import ASK
    from jbf.units.unit import parse_unit

    outcomes = {"jbf": {t: unit_outcome(own_unit(t), w, s) for t, (s, w) in UNITS.items()}}
    times = {"jbf": import_seconds("from jbf.units.unit import parse_unit; parse_unit('N m')")}
    pint = library("pint")
    if pint is not None:
        import logging
        import re

        logging.getLogger("pint").setLevel(logging.ERROR)
        plain = pint.UnitRegistry()
        rewrites = [
            lambda text, p=re.compile(pattern), to=to: p.sub(to, text)
            for pattern, to in PINT_REWRITES
        ]
        extended = pint.UnitRegistry(preprocessors=rewrites)
        for line in PINT_DEFINITIONS:
            extended.define(line)
        name = f"pint {version('pint')}"
        lines = len(PINT_DEFINITIONS) + len(PINT_REWRITES)
        for label, registry in ((name, plain), (f"{name}, {lines} lines of definitions", extended)):
            outcomes[label] = {
                t: unit_outcome(pint_unit(registry, t), w, s) for t, (s, w) in UNITS.items()
            }
            times[label] = import_seconds("import pint; pint.UnitRegistry().parse_units('N * m')")
    head = ("units", "right", "refused", "wrong", "wrong readings", "import, s")
    table(head, ([k, *counted(v), f"{times[k]:.2f}"] for k, v in outcomes.items()))
    if pint is not None:
        readings = np.arange(1.0, 1e6)
        exact = readings / 1000.0
        ours = parse_unit("ms").converted(readings, parse_unit("s"))
        theirs = plain.Quantity(readings, "ms").to("s").magnitude
        took = seconds(lambda: pint_unit(plain, "2**2**28"))
        rows = [
            ("share of ms to s that is inexact", np.mean(ours != exact), np.mean(theirs != exact)),
            ("seconds for the text `2**2**28`", seconds(lambda: parse_unit("2**2**28")), took),
        ]
        table(("units", "jbf", "pint"), ((n, f"{a:.3g}", f"{b:.3g}") for n, a, b in rows))
    questions = sum(text in ASK for text in TWO_MEANINGS)
    print(
        f"\nTexts with two meanings: jbf asks for {questions} of {len(TWO_MEANINGS)}, "
        "pint for none."
    )


# Dates


def nanoseconds(moment: datetime) -> int:
    utc = moment.replace(tzinfo=moment.tzinfo or timezone.utc)
    since = utc - datetime(1970, 1, 1, tzinfo=timezone.utc)
    return ((since.days * 86400 + since.seconds) * 10**6 + since.microseconds) * 1000


def own_date(cell: str) -> int | None:
    from jbf.errors import InputError
    from jbf.importing.formats.dates import Instants, day_or_month_first

    try:
        return int(Instants(day_or_month_first([cell]) or "day_first").parse([cell], [False])[0])
    except InputError:
        return None


def date_outcome(read: Callable[[str], Any], cell: str, wanted: int | None) -> Outcome:
    try:
        instant = read(cell)
    except Exception:
        return None if wanted is not None else ""
    if instant == wanted:
        return ""
    return None if instant is None else str(np.datetime64(instant, "ns"))


def compare_dates(stamps: int) -> None:
    """Print which dates jbf and dateutil read correctly, and their times for `stamps` stamps."""
    from jbf.importing.formats.dates import Instants, day_or_month_first
    from jbf.importing.formats.table import BLOCK

    epoch = datetime(1970, 1, 1)
    readers: dict[str, Callable[[str], Any]] = {"jbf": own_date}
    dateutil = library("dateutil.parser")
    if dateutil is not None:
        name = f"dateutil {version('python-dateutil')}"
        for first in (False, True):
            readers[f"{name}, dayfirst={first}"] = lambda cell, first=first: nanoseconds(
                dateutil.parse(cell, default=epoch, dayfirst=first)
            )
    cells = {**DATES, **dict.fromkeys(NO_DATES)}
    head = ("dates", "right", "refused", "wrong", "wrong readings")
    rows = []
    for label, read in readers.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            rows.append([label, *counted({c: date_outcome(read, c, w) for c, w in cells.items()})])
    table(head, rows)
    right = sum(day_or_month_first(column) == order for column, order in ORDERS)
    print(
        f"\nColumns whose order of day and month jbf decides or asks for: {right} of {len(ORDERS)}."
    )

    def in_blocks(column: list[str]) -> None:
        reader, empty = Instants(), [False] * BLOCK
        for at in range(0, len(column), BLOCK):
            cells = column[at : at + BLOCK]
            reader.parse(cells, empty[: len(cells)])

    base = np.datetime64("2026-11-24T00:00:00", "ms") + 20 * np.arange(stamps)
    iso = [str(moment) for moment in base]
    german = [f"{s[8:10]}.{s[5:7]}.{s[:4]} {s[11:].replace('.', ',')}" for s in iso]
    times = []
    for label, column in (("ISO 8601", iso), ("31.12.2026 23:59:59,125", german)):
        took = {"jbf": seconds(lambda c=column: in_blocks(c))}
        if dateutil is not None:
            few = column[: max(stamps // 50, 1)]
            each = seconds(lambda f=few: [dateutil.parse(c, dayfirst=True) for c in f])
            took["dateutil"] = each * stamps / len(few)
        times.append([label, f"{took['jbf']:.2f}", f"{took.get('dateutil', math.nan):.2f}"])
    table((f"seconds for {stamps:,} stamps", "jbf", "dateutil (of a fiftieth)"), times)


# Text dialects


Detected = tuple[str, str | None, bool]
"""Detected delimiter and decimal mark, and whether the row of the names was found."""


def detectors() -> dict[str, Callable[[Path, Text], Detected]]:
    """Return the function of each library that detects the dialect of a text file."""
    from jbf.importing.formats.csv_text import TextSource
    from jbf.importing.formats.table import Options

    clevercsv, duckdb = library("clevercsv"), library("duckdb")

    def header_found(answer: bool, text: Text) -> bool:
        """Return True if the detected presence of a header is right and locates its row."""
        return text.header < 2 and answer == (text.header == 1)

    def jbf_detector(path: Path, text: Text) -> Detected:
        source = TextSource(path, Options())
        return source.dialect.delimiter, source.dialect.decimal, source.layout.names == text.names

    def sniffer(path: Path, text: Text) -> Detected:
        sample = path.read_text(text.encoding)
        dialect = csv.Sniffer().sniff(sample, delimiters=",;\t| ")
        return dialect.delimiter, None, header_found(csv.Sniffer().has_header(sample), text)

    def clever(path: Path, text: Text) -> Detected:
        sample = path.read_text(text.encoding)
        detector = clevercsv.Detector()
        dialect = detector.detect(sample)
        return dialect.delimiter, None, header_found(detector.has_header(sample), text)

    def duck(path: Path, text: Text) -> Detected:
        query = "select Delimiter, HasHeader, SkipRows from sniff_csv(?)"
        delimiter, header, skipped = duckdb.execute(query, [str(path)]).fetchone()
        right = skipped + 1 == text.header if header else text.header == 0
        return delimiter, None, right

    known = {"jbf": jbf_detector, "csv.Sniffer": sniffer}
    if clevercsv is not None:
        known[f"clevercsv {version('clevercsv')}"] = clever
    if duckdb is not None:
        known[f"duckdb {version('duckdb')}"] = duck
    return known


def compare_texts(megabytes: float) -> None:
    """Compare the dialect detection of several libraries on generated files, and its speed."""
    cases = texts()
    with tempfile.TemporaryDirectory() as folder:
        paths = {name: Path(folder) / f"{i}.csv" for i, name in enumerate(cases)}
        for name, text in cases.items():
            paths[name].write_bytes(text.data)
        rows = []
        for label, detect in detectors().items():
            missed: dict[str, list[str]] = {"delimiter": [], "decimal": [], "names": []}
            for name, text in cases.items():
                try:
                    detected = detect(paths[name], text)
                except Exception:
                    detected = ("", None, False)
                wanted = (text.delimiter, text.decimal, True)
                for part, got, right in zip(missed, detected, wanted, strict=True):
                    if got != right:
                        missed[part].append(name)
            shown = [
                f"{len(cases) - len(names)}" + (f" (not: {', '.join(names)})" if names else "")
                for names in missed.values()
            ]
            rows.append([label, *shown] if label == "jbf" else [label, shown[0], "-", shown[2]])
        head = (f"of {len(cases)} generated files", "delimiter", "decimal mark", "row of the names")
        table(head, rows)
        compare_speed(Path(folder), megabytes)


def compare_speed(folder: Path, megabytes: float) -> None:
    """Compare the times to detect the dialect of one file and to read its samples, in turn."""
    from jbf.importing.formats.csv_text import TextSource
    from jbf.importing.formats.table import Options

    count = int(megabytes * 1e6 / 34)
    values = np.random.default_rng(1).normal(size=(count, 3)) * (1.0, 10.0, 100.0)
    values = np.column_stack([1e-3 * np.arange(count), values])
    body = io.StringIO()
    np.savetxt(body, values, delimiter=",", fmt="%.6f")
    path = folder / "large.csv"
    path.write_text("Zeit [s],Weg [mm],Kraft [N],Drehzahl [rpm]\n" + body.getvalue())
    text = path.read_text()
    source = TextSource(path, Options())
    names = [column.name for column in source.tables[0].columns]
    detect: dict[str, Callable[[], object]] = {
        "jbf": lambda: TextSource(path, Options()),
        "csv.Sniffer": lambda: csv.Sniffer().sniff(text, delimiters=",;\t| "),
    }
    read: dict[str, Callable[[], object]] = {
        "jbf": lambda: list(source.blocks(source.tables[0], names)),
        "numpy.loadtxt": lambda: np.loadtxt(path, delimiter=",", skiprows=1),
    }
    if (clevercsv := library("clevercsv")) is not None:
        detect["clevercsv, first 100 kB"] = lambda: clevercsv.Detector().detect(text[:100_000])
        detect["clevercsv"] = lambda: clevercsv.Detector().detect(text)
    if (duckdb := library("duckdb")) is not None:
        detect["duckdb"] = lambda: duckdb.execute("from sniff_csv(?)", [str(path)]).fetchone()
    if (pandas := library("pandas")) is not None:
        read["pandas"] = lambda: pandas.read_csv(path)
    if (polars := library("polars")) is not None:
        read["polars"] = lambda: polars.read_csv(path)
    size = path.stat().st_size / 1e6
    for what, works in (("detection", detect), ("reading", read)):
        turns: dict[str, list[float]] = {name: [] for name in works}
        for _ in range(3):
            for name, work in works.items():
                if not (name == "clevercsv" and turns[name]):  # takes minutes, run once
                    turns[name].append(seconds(work))
        medians = {name: median(took) for name, took in turns.items()}
        table(
            (f"{what}, {size:.1f} MB, 4 columns", "s", "times jbf's"),
            ((n, f"{s:.3g}", f"{s / medians['jbf']:.3g}") for n, s in medians.items()),
        )


def main() -> None:
    """Run all comparisons and print their tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=["units", "dates", "texts"], help="one of the tables")
    parser.add_argument("--stamps", type=int, default=1_000_000)
    parser.add_argument("--megabytes", type=float, default=5.0)
    options = parser.parse_args()
    if options.only in (None, "units"):
        compare_units()
    if options.only in (None, "dates"):
        compare_dates(options.stamps)
    if options.only in (None, "texts"):
        compare_texts(options.megabytes)


if __name__ == "__main__":
    main()
