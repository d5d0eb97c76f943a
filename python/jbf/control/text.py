"""Tables, runs and robustness as plain text."""

from __future__ import annotations

import statistics
from collections.abc import Sequence

from jbf.control.constants import FALLBACK, FROZEN, JUMPED, NOT_FINITE, SATURATED
from jbf.control.robustness import HARM, HELP, Outcome
from jbf.control.run import Result
from jbf.control.task import RECORDED
from jbf.control.thesis_tables import COLUMNS, Cell, Tables
from jbf.models.model import Model
from jbf.reporting.paragraphs import columns
from jbf.reporting.words import number

_TITLES = {"none": "no compensation", "learning": "dynamic model, learned", "coulomb": "Coulomb"}
_FAR = 2.0
_FLAGS = {
    SATURATED: "saturated",
    FROZEN: "encoder frozen",
    JUMPED: "encoder jumped",
    NOT_FINITE: "reference not finite",
    FALLBACK: "control law alone",
}


def _three(value: float | None) -> str:
    return "-" if value is None else number(value, 3)


def _ratio(cell: Cell) -> str:
    return "-" if cell.ratio is None else f"{cell.ratio:.2f}"


def friction_lines(model: Model, volts_per_n: float, load_n: float) -> list[str]:
    """The four fitted numbers."""
    values = {n: p.value for n, p in model.parameters.items()}  # type: ignore[union-attr]
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
    """Bench, thesis and ratio for each row and column."""
    extra = [c for c in {key[1]: None for key in tables.cells} if c not in COLUMNS]
    rows: list[tuple[str, ...]] = []
    head = ("", *(f"{_TITLES[c]}" for c in COLUMNS), *extra)
    rows.append(head)
    for row in {key[0]: None for key in tables.cells}:
        cells = [
            f"{_three(c.rms)} / {_three(c.printed_rms)} = {_ratio(c)}"
            for c in (tables[row, column] for column in COLUMNS)
        ]
        rows.append((row, *cells, *(_three(tables[row, c].rms) for c in extra)))
    lines = ["RMS error, rad or rad/s: bench / thesis = ratio", ""]
    lines += columns(rows, "<" * len(head))
    rows = [head]
    for row in {key[0]: None for key in tables.cells}:
        cells = [
            f"{_three(c.peak)} / {_three(c.printed_peak)}"
            for c in (tables[row, column] for column in COLUMNS)
        ]
        rows.append((row, *cells, *(_three(tables[row, c].peak) for c in extra)))
    lines += ["", "Peak error, likewise: bench / thesis", ""]
    lines += columns(rows, "<" * len(head))
    return "\n".join(lines)


def score_text(tables: Tables) -> str:
    """How many of the predicted cells are near, and which are not."""
    worst = max(abs(c.ratio - 1.0) for c in tables.column("none") if c.ratio is not None)
    far = [
        f"{c.row}, {_TITLES[c.column]} ({c.ratio:.2f})"
        for c in tables.predicted
        if c.ratio is not None and not 1.0 / _FAR <= c.ratio <= _FAR
    ]
    lines = [
        f"Fitted: the seven cells without compensation, worst {100.0 * worst:.0f} % off.",
        f"Predicted: of {len(tables.predicted)} cells {tables.within(2.0)} within a factor of 2, "
        f"{tables.within(1.5)} within 1.5.",
    ]
    if far:
        lines.append(f"Further off: {'; '.join(far)}.")
    return "\n".join(lines)


def assumptions_text(found: Sequence[tuple[str, Tables]]) -> str:
    """Ratios to the thesis under other assumptions, one line each."""
    rows: list[tuple[str, ...]] = [("", "dynamic model, learned", "Coulomb", "in 2", "in 1.5")]
    for name, tables in found:
        learning = " ".join(_ratio(c) for c in tables.column("learning"))
        coulomb = " ".join(_ratio(c) for c in tables.column("coulomb"))
        rows.append((name, learning, coulomb, str(tables.within(2.0)), str(tables.within(1.5))))
    head = "Other assumptions: ratios of the RMS, row by row, and cells within a factor"
    return "\n".join([head, "", *columns(rows, "<<<>>")])


def better_text(tables: Tables) -> str:
    """Ours against the better of the thesis's two schemes, by what the shaft truly did."""
    gains = tables.gains()
    rows: list[tuple[str, ...]] = [("", "dynamic model", "Coulomb", "observed", "times better")]
    for row, gain in gains.items():
        cells = (_three(tables[row, c].true_rms) for c in ("learning", "coulomb", "observed"))
        rows.append((row, *cells, f"{gain:.1f}"))
    return "\n".join(
        [
            "True RMS error (of the shaft, not of the loop's estimate), rad or rad/s:",
            "",
            *columns(rows, "<>>>>"),
            "",
            f"The observed compensator has the lower error in {sum(g > 1 for g in gains.values())} "
            f"of {len(gains)} rows, {statistics.median(gains.values()):.1f} times in the median.",
        ]
    )


def status_words(result: Result) -> str:
    """What the loop said of itself, and for how much of the run."""
    said = []
    for flag, word in _FLAGS.items():
        share = float(((result.status & flag) > 0).mean())
        if share > 0.0:
            said.append(f"{word} {100.0 * share:.2g} %")
    return ", ".join(said) or "ok"


def runs_text(results: Sequence[Result]) -> str:
    """RMS and peak of several schemes on one task."""
    task = results[0].task
    head = f"{task.control} control, {task.wave} {task.low:.3g} to {task.high:.3g} {task.unit}"
    if task.wave != RECORDED:
        head += f" at {task.frequency_rad_s:g} rad/s"
    head += f", {task.seconds:g} s"
    if task.skip_s:
        head += f", the first {task.skip_s:g} s left out"
    rows = [("scheme", f"RMS, {task.unit}", "peak", "true RMS", "status")]
    rows += [
        (r.scheme, _three(r.rms), _three(r.peak), _three(r.true_rms), status_words(r))
        for r in results
    ]
    return "\n".join([head, "", *columns(rows, "<>>><")])


def robustness_text(outcomes: Sequence[Outcome]) -> str:
    """Ratio of error with and without compensation, case by case."""
    names = list(outcomes[0].ratios)
    short = [
        "".join(word[0] if i == 0 else f" {word}" for i, word in enumerate(n.split()))
        for n in names
    ]
    rows: list[tuple[str, ...]] = [("plant", *short, "worst", "")]
    rows += [
        (o.name, *(f"{o.ratios[n]:.3f}" for n in names), f"{o.worst:.3f}", o.verdict)
        for o in outcomes
    ]
    counted = {
        word: sum(o.verdict == word for o in outcomes) for word in ("help", "neutral", "harm")
    }
    summary = ", ".join(f"{word} {count}" for word, count in counted.items())
    return "\n".join(
        [
            "True RMS error with compensation over that without; the compensator carries the bare "
            "law.",
            f"help: every row below {HELP:g}; harm: a row above {HARM:g}; p position, v velocity.",
            "",
            *columns(rows, "<" + ">" * (len(names) + 1) + "<"),
            "",
            summary,
        ]
    )
