"""Results of a study as Markdown tables."""

from __future__ import annotations

from collections import Counter

import numpy as np
from work import Row

OUTCOMES = ("right", "tied", "abstained", "wrong")


def _share(count: int, total: int) -> str:
    return f"{count} of {total}" if total else "-"


def summary(rows: list[Row]) -> str:
    """Return a table of outcomes by kind of campaign, with time and held-out error."""
    lines = [
        "| hidden | campaigns | right | honest tie | abstained | wrong | held-out / noise, median "
        "| worst | s, median |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for kind in dict.fromkeys(row["kind"] for row in rows):
        of_kind = [row for row in rows if row["kind"] == kind]
        count = Counter(row["judged"] for row in of_kind)
        ratio = [row["held_out_over_noise"] for row in of_kind]
        seconds = np.median([row["seconds"] for row in of_kind])
        cells = " | ".join(_share(count[o], len(of_kind)) for o in OUTCOMES)
        lines.append(
            f"| {kind} | {len(of_kind)} | {cells} | {np.median(ratio):.3f} | {max(ratio):.3f} "
            f"| {seconds:.1f} |"
        )
    return "\n".join(lines)


def confusion(rows: list[Row]) -> str:
    """Return a table of the named effects by hidden effect, for at most one hidden effect."""
    results: dict[str, Counter[str]] = {}
    for row in rows:
        if row["kind"] == "pair":
            continue
        name = " + ".join(row["named"]) or row["verdict"]
        if row["verdict"] == "ambiguous":
            others = {a for tied in row["alternatives"].values() for a in tied}
            name += " or " + ", ".join(sorted(others))
        elif row["named"] and row["verdict"] == "unexplained":
            name += " + unexplained"
        hidden = row["hidden"] + (" (no such effect)" if row["kind"] == "foreign" else "")
        results.setdefault(hidden, Counter())[name] += 1
    lines = ["| hidden | result |", "|---|---|"]
    for hidden, names in sorted(results.items()):
        words = ", ".join(f"{name} ({n})" for name, n in names.most_common())
        lines.append(f"| {hidden} | {words} |")
    return "\n".join(lines)


def rivals(rows: list[Row]) -> str:
    """Return a table of the rates of right results of jbf and each simpler rule, by kind."""
    known = [row for row in rows if "rivals" in row]
    if not known:
        return ""
    rules = list(known[0]["rivals"])
    lines = ["| hidden | jbf | " + " | ".join(rules) + " |", "|---" * (len(rules) + 2) + "|"]
    for kind in dict.fromkeys(row["kind"] for row in known):
        of_kind = [row for row in known if row["kind"] == kind]
        good = ("right", "tied")
        cells = [_share(sum(row["judged"] in good for row in of_kind), len(of_kind))]
        for rule in rules:
            cells.append(_share(sum(row["rivals"][rule] in good for row in of_kind), len(of_kind)))
        lines.append(f"| {kind} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def next_runs(rows: list[Row]) -> str:
    """Return the rate of ties that the proposed run resolves, as text."""
    outcomes = [row["after_next_run"] for row in rows if row.get("after_next_run")]
    if not outcomes:
        return ""
    right = sum(outcome == "right" for outcome in outcomes)
    random = sum(row.get("after_random_run") == "right" for row in rows)
    return (
        f"ties for which a run was proposed: {len(outcomes)}; that run names the one: {right}; "
        f"a run at random, as long: {random}"
    )


def shares(rows: list[Row], least: float) -> bool:
    """Return True if the rate of right results and valid ties of each kind is at least `least`.

    The kinds below are printed.
    """
    good = True
    for kind in dict.fromkeys(row["kind"] for row in rows):
        acceptable = [row["judged"] in ("right", "tied") for row in rows if row["kind"] == kind]
        if np.mean(acceptable) < least:
            print(
                f"{kind}: {sum(acceptable)} of {len(acceptable)} good answers, fewer than {least:g}"
            )
            good = False
    return good


def tables(rows: list[Row]) -> str:
    """Return all tables as one text."""
    parts = [summary(rows), confusion(rows), rivals(rows), next_runs(rows)]
    return "\n\n".join(["", *(part for part in parts if part)])
