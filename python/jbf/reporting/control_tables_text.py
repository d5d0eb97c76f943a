"""Fitted and predicted tables of Cohn (1998) as plain text."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from jbf.control.thesis_tables import COLUMNS, Cell, Tables
from jbf.models.model import Model
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import number

_TITLES = {"none": "no compensation", "learning": "dynamic model, learned", "coulomb": "Coulomb"}
_LISTED_RATIO = 2.0


def _three_digits(value: float | None) -> str:
    return "-" if value is None else number(value, 3)


def _ratio(cell: Cell) -> str:
    return "-" if cell.ratio is None else f"{cell.ratio:.2f}"


def friction_lines(model: Model, volts_per_n: float, load_n: float) -> list[str]:
    """Format the four friction parameters that were fitted to the tables."""
    values = {n: p.value for n, p in model.parameters.items()}
    return columns(
        [
            ("friction scale", f"{number(volts_per_n * load_n, 4)} V", "for a coefficient of 1"),
            ("U_tr", f"{number(values['U_tr_m_s'], 4)} m/s", ""),
            ("K0", f"{values['K0']:.4g}", ""),
            ("gamma", f"{number(values['gamma'], 4)}", ""),
        ],
        "<<<",
    )


def tables_text(tables: Tables) -> str:
    """Tabulate the RMS errors of simulated bench and thesis, and their ratio, for each cell."""
    extra = [c for c in {key[1]: None for key in tables.cells} if c not in COLUMNS]
    rows: list[tuple[str, ...]] = []
    head = ("", *(f"{_TITLES[c]}" for c in COLUMNS), *extra)
    rows.append(head)
    for row in {key[0]: None for key in tables.cells}:
        cells = [
            f"{_three_digits(c.rms)} / {_three_digits(c.printed_rms)} = {_ratio(c)}"
            for c in (tables[row, column] for column in COLUMNS)
        ]
        rows.append((row, *cells, *(_three_digits(tables[row, c].rms) for c in extra)))
    lines = ["RMS error, rad or rad/s: bench / thesis = ratio", ""]
    lines += columns(rows, "<" * len(head))
    rows = [head]
    for row in {key[0]: None for key in tables.cells}:
        cells = [
            f"{_three_digits(c.peak)} / {_three_digits(c.printed_peak)}"
            for c in (tables[row, column] for column in COLUMNS)
        ]
        rows.append((row, *cells, *(_three_digits(tables[row, c].peak) for c in extra)))
    lines += ["", "Peak error, rad or rad/s: bench / thesis", ""]
    lines += columns(rows, "<" * len(head))
    return "\n".join(lines)


def score_text(tables: Tables) -> str:
    """Report how many predicted cells agree with the thesis within factors of 2 and 1.5.

    The worst deviation of the fitted cells comes first, and the other cells are listed.
    """
    worst = max(abs(c.ratio - 1.0) for c in tables.column("none") if c.ratio is not None)
    outlying = [
        f"{c.row}, {_TITLES[c.column]} ({c.ratio:.2f})"
        for c in tables.predicted
        if c.ratio is not None and not 1.0 / _LISTED_RATIO <= c.ratio <= _LISTED_RATIO
    ]
    lines = [
        f"Fitted: the seven cells without compensation, largest deviation {100.0 * worst:.0f} %.",
        f"Predicted: {len(tables.predicted)} cells, {tables.within(2.0)} within a factor of 2, "
        f"{tables.within(1.5)} within 1.5.",
    ]
    if outlying:
        lines.append(f"Larger deviations: {'; '.join(outlying)}.")
    return "\n".join(lines)


def assumptions_text(alternatives: Sequence[tuple[str, Tables]]) -> str:
    """Tabulate the ratios to the thesis under alternative assumptions, one line each."""
    rows: list[tuple[str, ...]] = [("", "dynamic model, learned", "Coulomb", "in 2", "in 1.5")]
    for name, tables in alternatives:
        learning = " ".join(_ratio(c) for c in tables.column("learning"))
        coulomb = " ".join(_ratio(c) for c in tables.column("coulomb"))
        rows.append((name, learning, coulomb, str(tables.within(2.0)), str(tables.within(1.5))))
    head = "Alternative assumptions: RMS ratios row by row, and number of cells within a factor"
    return "\n".join([head, "", *columns(rows, "<<<>>")])


def better_text(tables: Tables) -> str:
    """Compare the observed compensator with the better of the two schemes of Cohn (1998).

    The criterion is the true RMS error of the shaft.
    """
    gains = tables.gains()
    rows: list[tuple[str, ...]] = [("", "dynamic model", "Coulomb", "observed", "improvement")]
    for row, gain in gains.items():
        cells = (
            _three_digits(tables[row, c].true_rms) for c in ("learning", "coulomb", "observed")
        )
        rows.append((row, *cells, f"{gain:.1f}"))
    return "\n".join(
        [
            "True RMS error (of the shaft, not of the loop's estimate), rad or rad/s:",
            "",
            *columns(rows, "<>>>>"),
            "",
            "The observed compensator has the lower error in "
            f"{sum(g > 1 for g in gains.values())} of {len(gains)} rows; the median "
            f"improvement is {statistics.median(gains.values()):.1f}.",
        ]
    )


def tables_report(tables: Tables, alternatives: Sequence[tuple[str, Tables]]) -> str:
    """Complete output of `jbf control tables`."""
    load = tables.model.rig.load
    load_n = 0.0 if load is None else load.normal_n
    return "\n".join(
        [
            "Friction of the bench, fitted to the seven cells without compensation:",
            "",
            *friction_lines(tables.model, tables.bench.volts_per_n, load_n),
            "",
            tables_text(tables),
            "",
            score_text(tables),
            "",
            assumptions_text(alternatives),
            "",
            better_text(tables),
            "",
            "docs/control.md describes how scale, clock, start and missing effect were determined,",
            "and explains the larger deviations.",
        ]
    )
