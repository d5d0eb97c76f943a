"""Compare diagnoses with the rates that the documentation states: `python benches/promises.py`.

The arguments are files with the JSON lines of `benches/hidden_effects`, `benches/recorded` and
`benches/power_kept.py` (`--out`). For each promise with campaigns among them,
docs/results/rates.csv receives the fraction of campaigns that kept it with a 95 % interval (Clopper
& Pearson 1934), and docs/results/broken.csv the campaigns that broke it. Then the tables of
docs/validation.md are written from the files in docs/results, so that a new figure is entered in
one place. `--check` writes nothing, and exits with 1 if a table differs; `--least N` exits with 1
if a promise has fewer campaigns.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scipy import stats

sys.path.insert(0, str(Path(__file__).resolve().parent / "recorded"))

from judge import FAIR

Row = dict[str, Any]


@dataclass(frozen=True)
class Promise:
    """Rate that the documentation states, with its campaigns and the condition for each."""

    words: str
    nominal: str
    of: Callable[[Row], bool]
    kept: Callable[[Row], bool]


def recorded(row: Row) -> bool:
    """Return True if the campaign has recording artefacts."""
    return "artefacts" in row


def hidden(row: Row) -> set[str]:
    """Return the hidden effects of the catalogue."""
    return set(row["effects"] if recorded(row) else filter(None, row["hidden"].split("+")))


def false_name(row: Row) -> bool:
    """Return True if the diagnosis names an effect that is neither hidden nor in a valid tie."""
    true = set() if row["kind"] == "foreign" else hidden(row)
    # A delayed force is a delay, whatever its cause.
    true = true.union(*(FAIR.get(name, set()) for name in row.get("artefacts", ())))
    could = [{name, *row["alternatives"].get(name, ())} for name in row["named"]]
    return any(not names & true for names in could)


def right(row: Row) -> bool:
    """Return True if the diagnosis names exactly the hidden effects, or they are in a valid tie."""
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
            condition = _kind(kind, logged=logged)
            nominal = "90 %" if logged else "98 %"
            yield Promise(f"{words}, {where}: named, nothing false", nominal, condition, right)
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
DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGE, RESULTS = DOCS / "validation.md", DOCS / "results"
COVERAGE = "95 % intervals of a right answer's parameters: hold the truth"
TABLE = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.S)


def interval(count: int, campaigns: int) -> tuple[float, float, float]:
    """Return the fraction `count / campaigns` and its exact 95 % interval, in per cent."""
    sure = stats.binomtest(count, campaigns).proportion_ci(0.95, method="exact")
    return 100.0 * count / campaigns, 100.0 * sure.low, 100.0 * sure.high


def coverage(rows: Sequence[Row]) -> tuple[float, float, float, int]:
    """Return the coverage of parameter intervals, its 95 % interval, and the number of campaigns.

    The coverage is that of right results, in per cent.

    The intervals of one campaign are correlated, so the error is that of means over campaigns.
    """
    known = [row for row in rows if row.get("intervals")]
    count = sum(row["intervals"] for row in known)
    share = sum(row["covered"] for row in known) / count
    off = [row["covered"] - share * row["intervals"] for row in known]
    error = math.sqrt(sum(x * x for x in off)) / count
    low, high = (100.0 * min(max(share + z * error, 0.0), 1.0) for z in (-1.96, 1.96))
    return 100.0 * share, low, high, len(known)


def delivered(rows: Sequence[Row]) -> Iterator[tuple[str, tuple[float, float, float, int]]]:
    """Generate for each promise its name, the fraction that kept it, interval and campaigns."""
    for promise in PROMISES:
        relevant = [row for row in rows if promise.of(row)]
        if relevant:
            yield (
                promise.words,
                (*interval(sum(map(promise.kept, relevant)), len(relevant)), len(relevant)),
            )
    if any(row.get("intervals") for row in rows):
        yield COVERAGE, coverage(rows)


def broken(rows: Sequence[Row]) -> Iterator[dict[str, str]]:
    """Generate a row for each campaign that broke a promise."""
    for promise in PROMISES:
        for row in rows:
            if promise.of(row) and not promise.kept(row):
                yield {
                    "statement": promise.words,
                    "campaign": row["key"],
                    "verdict": str(row["verdict"]).lower(),
                    "named": ", ".join(row["named"]),
                }


def read(name: str) -> list[dict[str, str]]:
    """Read the rows of a file in docs/results."""
    with (RESULTS / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def write(name: str, rows: Sequence[Mapping[str, str]]) -> None:
    """Replace the rows of a file in docs/results; its columns remain."""
    columns = list(read(name)[0])
    with (RESULTS / f"{name}.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def enter(rows: Sequence[Row]) -> None:
    """Enter the rates of new campaigns, and replace the broken promises."""
    new = dict(delivered(rows))
    kept = [row for row in read("broken") if row["statement"] not in new]
    rates = read("rates")
    listed = {row["statement"] for row in rates}
    rates += [
        {"statement": p.words, "nominal": p.nominal.rstrip(" %"), "study": "tidy"}
        for p in PROMISES
        if p.words in new.keys() - listed
    ]
    for row in rates:
        if row["statement"] in new:
            *shares, campaigns = new[row["statement"]]
            names = ("delivered", "low", "high")
            row.update(zip(names, (f"{x:.1f}" for x in shares), strict=True))
            row["campaigns"] = str(campaigns)
    write("rates", rates)
    write("broken", [*kept, *broken(rows)])


def _rates() -> Iterator[Sequence[str]]:
    yield "statement", "promised, %", "measured, %", "95 % interval", "campaigns", "study"
    for row in read("rates"):
        met = not row["nominal"] or float(row["delivered"]) >= float(row["nominal"])
        measured = row["delivered"] if met else f"**{row['delivered']}**"
        between = f"{row['low']} to {row['high']}"
        yield (
            row["statement"],
            row["nominal"],
            measured,
            between,
            row["campaigns"],
            row["study"],
        )


def _servo() -> Iterator[Sequence[str]]:
    yield (
        "hidden",
        "right",
        "95 % interval",
        "tied",
        "false name",
        "unexplained",
        "missed",
        "held-out error, median",
        "worst",
    )
    for row in read("servo"):
        count, campaigns = int(row["right"]), int(row["campaigns"])
        _, low, high = interval(count, campaigns)
        missed = int(row["missed"]) + int(row["not_reported"])
        yield (
            row["hidden"],
            f"{count} of {campaigns}",
            f"{low:.0f} to {high:.0f} %",
            row["tied"],
            row["false_name"],
            row["unexplained"],
            str(missed),
            row["ratio_median"],
            row["ratio_worst"],
        )


def _studies() -> Iterator[Sequence[str]]:
    yield "study", "campaigns", "command", "commit, date"
    for row in read("studies"):
        yield row["study"], row["campaigns"], row["command"], f"{row['commit']}, {row['date']}"


TABLES = {"rates": _rates, "servo": _servo, "studies": _studies}


def page(text: str) -> str:
    """Return the text of docs/validation.md with every table written anew."""

    def table(match: re.Match[str]) -> str:
        head, *rows = TABLES[match[2]]()
        lines = [f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows)]
        return match[1] + "\n".join(lines) + "\n" + match[3]

    return TABLE.sub(table, text)


def main() -> int:
    """Enter new results and write docs/validation.md, or check it."""
    parser = argparse.ArgumentParser(prog="promises", description=__doc__.split(":")[0])
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE")
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("--least", type=int, default=0, metavar="N", help="campaigns of each; 0")
    options = parser.parse_args()
    rows = [
        json.loads(line)
        for file in options.files
        for line in file.read_text(encoding="utf-8").splitlines()
    ]
    if rows and not options.check:
        enter(rows)
    text = PAGE.read_text(encoding="utf-8")
    new = page(text)
    if options.check:
        return int(new != text)
    PAGE.write_text(new, encoding="utf-8")
    fewest = min(sum(map(promise.of, rows)) for promise in PROMISES)
    return int(fewest < options.least)


if __name__ == "__main__":
    sys.exit(main())
