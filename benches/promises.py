"""What is promised of a diagnosis, and what it delivered: `python benches/promises.py FILE...`.

The files are JSON lines of `benches/hidden_effects`, `benches/recorded` and `benches/power_kept.py`
(`--out`). Each promise is printed with its nominal rate, the observed share, its standard error and
a 95 % interval (Clopper & Pearson 1934), and the number of campaigns. Each campaign that broke the
promise is listed below the table. Prints Markdown; `--least N` fails if a promise has fewer
campaigns.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scipy import stats

sys.path.insert(0, str(Path(__file__).resolve().parent / "recorded"))

from judge import FAIR

Row = dict[str, Any]


@dataclass(frozen=True)
class Promise:
    """A promise, the campaigns to which it applies, and the condition under which it is kept."""

    words: str
    nominal: str
    of: Callable[[Row], bool]
    kept: Callable[[Row], bool]


def recorded(row: Row) -> bool:
    """Whether the campaign has recording artefacts."""
    return "artefacts" in row


def hidden(row: Row) -> set[str]:
    """The hidden effects of the catalogue."""
    return set(row["effects"] if recorded(row) else filter(None, row["hidden"].split("+")))


def false_name(row: Row) -> bool:
    """Whether a name was given that was not hidden, not even as a valid alternative."""
    true = set() if row["kind"] == "foreign" else hidden(row)
    # A delayed force is a delay, whatever its cause.
    true = true.union(*(FAIR.get(name, set()) for name in row.get("artefacts", ())))
    could = [{name, *row["alternatives"].get(name, ())} for name in row["named"]]
    return any(not names & true for names in could)


def right(row: Row) -> bool:
    """Whether exactly the hidden effects were named, or are contained in a valid tie."""
    return row["judged"] in ("right", "tied")


def _kind(kind: str, *, logged: bool) -> Callable[[Row], bool]:
    return lambda row: row["kind"] == kind and recorded(row) == logged


def _promises() -> Iterator[Promise]:
    def quiet(row: Row) -> bool:
        return not false_name(row)

    for where, logged in (("tidy", False), ("recorded", True)):
        none = _kind("none", logged=logged)
        yield Promise(f"nothing hidden, {where}: no name", "99 %", none, quiet)
        yield Promise(f"nothing hidden, {where}: `adequate`", "95 %", none, right)
        for words, kind in (("one effect", "single"), ("two effects", "pair")):
            own = _kind(kind, logged=logged)
            nominal = "90 %" if logged else "98 %"
            yield Promise(f"{words}, {where}: named, nothing false", nominal, own, right)
    foreign = _kind("foreign", logged=False)
    yield Promise(
        "what no catalogue has: `unexplained`",
        "95 %",
        foreign,
        lambda row: bool(row["verdict"] == "unexplained"),
    )
    yield Promise("what no catalogue has: no name", "95 %", foreign, lambda row: not row["named"])
    for words, kind in (
        ("an effect at its `detectable_80`: found", "power_found"),
        ("an effect at its `distinguishable_80`: named alone", "power_alone"),
    ):
        yield Promise(words, "80 %", lambda row, kind=kind: bool(row["kind"] == kind), right)

    def proposed(row: Row) -> bool:
        return bool(row.get("after_next_run"))

    yield Promise(
        "a tie, the proposed run recorded too: the one named",
        "90 %",
        proposed,
        lambda row: bool(row["after_next_run"] == "right"),
    )
    yield Promise(
        "the same, a run at random of equal length",
        "less",
        proposed,
        lambda row: bool(row["after_random_run"] == "right"),
    )


PROMISES = tuple(_promises())
HEAD = (
    "# What a diagnosis promises, and what it delivered",
    "Simulated campaigns that no development had seen: *tidy* ones as a simulator makes them,",
    "*recorded* ones with what loggers do to them. Nominal is what is promised; the interval holds",
    "the rate in 95 of 100 cases (Clopper & Pearson 1934). Every campaign in which a promise was",
    "broken stands below the table. Intervals effect by effect: [recovery.md](recovery.md).",
    "",
)


def coverage(rows: Sequence[Row]) -> str:
    """Coverage of the parameter intervals of right results.

    The intervals of one campaign are correlated, so the error is that of means over campaigns.
    """
    known = [row for row in rows if row.get("intervals")]
    words = "95 % intervals of a right answer's parameters: hold the truth"
    if not known:
        return f"| {words} | 95 % | - | | | 0 |"
    count = sum(row["intervals"] for row in known)
    share = sum(row["covered"] for row in known) / count
    off = [row["covered"] - share * row["intervals"] for row in known]
    error = math.sqrt(sum(x * x for x in off)) / count
    low, high = (100.0 * min(max(share + z * error, 0.0), 1.0) for z in (-1.96, 1.96))
    delivered = f"{100.0 * share:.1f} % | {100.0 * error:.1f} %"
    return f"| {words} | 95 % | {delivered} | {low:.1f} to {high:.1f} % | {len(known)} |"


def page(rows: Sequence[Row]) -> Iterator[str]:
    """Generate the table and every broken promise."""
    yield "| promise | nominal | delivered | standard error | 95 % interval | campaigns |"
    yield "| --- | --- | --- | --- | --- | --- |"
    broken = []
    for promise in PROMISES:
        own = [row for row in rows if promise.of(row)]
        if not own:
            yield f"| {promise.words} | {promise.nominal} | - | | | 0 |"
            continue
        count = sum(promise.kept(row) for row in own)
        share = count / len(own)
        error = math.sqrt(share * (1.0 - share) / len(own))
        sure = stats.binomtest(count, len(own)).proportion_ci(0.95, method="exact")
        delivered = f"{100.0 * share:.1f} % | {100.0 * error:.1f} %"
        interval = f"{100.0 * sure.low:.1f} to {100.0 * sure.high:.1f} %"
        yield f"| {promise.words} | {promise.nominal} | {delivered} | {interval} | {len(own)} |"
        broken += [(promise.words, row) for row in own if not promise.kept(row)]
    yield coverage(rows)
    yield ""
    for words, row in broken:
        named = ", ".join(row["named"]) or "nothing"
        yield f"- {words}: `{row['key']}` is `{row['verdict']}`, named {named}"


def main() -> int:
    """Read the files and print the page."""
    parser = argparse.ArgumentParser(prog="promises", description=__doc__.split(":")[0])
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--note", default="", help="where the files come from: commands, commit")
    parser.add_argument("--least", type=int, default=0, metavar="N", help="campaigns of each; 0")
    asked = parser.parse_args()
    rows = [
        json.loads(line)
        for file in asked.files
        for line in file.read_text(encoding="utf-8").splitlines()
    ]
    note = textwrap.wrap(asked.note, 100, break_on_hyphens=False)
    print("\n".join([*HEAD, *note, "", *page(rows)]))
    fewest = min(sum(map(promise.of, rows)) for promise in PROMISES)
    return 0 if fewest >= asked.least else 1


if __name__ == "__main__":
    sys.exit(main())
