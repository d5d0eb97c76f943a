"""Results of a study as Markdown tables."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from case import Row
from judge import OUTCOMES


def _held_out(rows: Sequence[Row]) -> list[str]:
    ratios = [row["held_out_over_noise"] for row in rows if "held_out_over_noise" in row]
    if not ratios:
        return ["-", "-"]
    return [f"{np.median(ratios):.3f}", f"{max(ratios):.3f}"]


def _found(rows: Sequence[Row]) -> str:
    detected = sum(len(row["found"]) for row in rows)
    total = detected + sum(len(row["not_found"]) for row in rows)
    return f"{detected} of {total}" if total else "-"


def _cpu_s(row: Row) -> float:
    return float(row["cpu_s"])


def _seconds(rows: Sequence[Row]) -> list[str]:
    seconds = [_cpu_s(row) for row in rows]
    return [f"{np.median(seconds):.0f}", f"{max(seconds):.0f}"]


def grouped(rows: Sequence[Row], title: str, of: Callable[[Row], str]) -> str:
    """Return a table of outcomes, held-out error over noise, found artefacts and time, by group."""
    heads = [title, "campaigns", *OUTCOMES, "all named"]
    heads += ["held-out, median", "worst", "artefacts found", "CPU s, median", "worst"]
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for name in sorted({of(row) for row in rows}):
        of_group = [row for row in rows if of(row) == name]
        counts = [str(sum(row["judged"] == o for row in of_group)) for o in OUTCOMES]
        hidden = [row for row in of_group if row["effects"]]
        named = f"{sum(row['names_all'] for row in hidden)} of {len(hidden)}" if hidden else "-"
        cells = [
            name,
            str(len(of_group)),
            *counts,
            named,
            *_held_out(of_group),
            _found(of_group),
            *_seconds(of_group),
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def recorded(row: Row) -> bool:
    """Return True if the campaign of a row has recording artefacts; `off_grid` is not one."""
    return set(row["artefacts"]) != {"off_grid"}


def _line(what: str, rows: Sequence[Row], good: Callable[[Row], bool]) -> str:
    if not rows:
        return f"| {what} | - | |"
    count = sum(good(row) for row in rows)
    return f"| {what} | {count} of {len(rows)} | {100.0 * count / len(rows):.1f} % |"


def totals(rows: Sequence[Row]) -> str:
    """Return a summary of the required rates in a few lines; failed campaigns are not right."""
    clean = [row for row in rows if not recorded(row)]
    dirty = [row for row in rows if recorded(row)]
    one = [row for row in dirty if row["kind"] == "single"]
    none = [row for row in dirty if row["kind"] == "none"]
    single = [row for row in rows if row["kind"] == "single"]
    of_none = [row for row in rows if row["kind"] == "none"]

    def right(row: Row) -> bool:
        return bool(row["judged"] == "right")

    def fair(row: Row) -> bool:
        return row["judged"] in ("right", "tied")

    lines = ["| | campaigns | share |", "|---|---|---|"]
    for words, kind in (("one effect", "single"), ("two effects", "pair"), ("nothing", "none")):
        of_kind = [row for row in clean if row["kind"] == kind]
        lines.append(_line(f"recorded cleanly, {words}: right", of_kind, right))
    lines.append(_line("recorded, one effect: named, nothing false, not `unexplained`", one, right))
    lines.append(_line("the same or an honest tie", one, fair))
    two = [row for row in dirty if row["kind"] == "pair"]
    lines.append(_line("recorded, two effects: right or an honest tie", two, fair))
    lines.append(_line("recorded, nothing hidden: no physics named, `adequate`", none, right))
    lines.append(_line("nothing hidden: physics named", of_none, _names))
    lines.append(_line("failed or over the time limit", rows, lambda r: r["judged"] == "failed"))
    median, worst = _held_out(single)
    lines.append(f"| held-out RMS over noise, one effect: median, worst | {median} | {worst} |")
    return "\n".join(lines)


def _names(row: Row) -> bool:
    return bool(row["judged"] == "named falsely")


def kept(rows: Sequence[Row]) -> float:
    """Return the fraction of campaigns whose result is right or a valid tie."""
    return float(np.mean([row["judged"] in ("right", "tied") for row in rows])) if rows else 0.0


def line(row: Row) -> str:
    """Format the result of a campaign as one line, for progress output."""
    named = ",".join(row["named"]) or "-"
    held = f"{row['held_out_over_noise']:7.3f}" if "held_out_over_noise" in row else "      -"
    hidden = ",".join(row["effects"]) or "-"
    why = ",".join(row["findings"]) or row.get("why", "")
    return (
        f"{row['key']:44} {hidden:34} {row['verdict']:12} {named:34} {row['judged']:14}{held}"
        f"{row['cpu_s']:7.1f} s  {why}"
    )


def tables(rows: Sequence[Row]) -> str:
    """Return all tables as one text."""
    parts = [
        grouped(rows, "artefacts", lambda row: " + ".join(row["artefacts"])),
        grouped(rows, "hidden", lambda row: row["kind"]),
    ]
    if any(row["strength"] != "-" for row in rows):
        parts.append(grouped(rows, "strength", lambda row: row["strength"]))
    return "\n\n".join(["", *parts, totals(rows)])
