"""Fraction of mutants that the tests detect, with its confidence interval."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

from scipy.stats import beta
from trial import Trial


def interval(caught: int, total: int, level: float = 0.95) -> tuple[float, float]:
    """Return the Clopper-Pearson interval of the fraction caught / total (Biometrika 26, 1934)."""
    tail = 0.5 * (1.0 - level)
    lower = beta.ppf(tail, caught, total - caught + 1) if caught else 0.0
    upper = beta.ppf(1.0 - tail, caught + 1, total - caught) if caught < total else 1.0
    return float(lower), float(upper)


def read(path: Path) -> list[Trial]:
    """Read the trials of a record.

    The last trial of each mutant counts, and incomplete lines are skipped.
    """
    trials: dict[tuple[str, int, str], Trial] = {}
    for line in path.read_text("utf-8").splitlines() if path.is_file() else []:
        try:
            trial = Trial(**json.loads(line))
        except (json.JSONDecodeError, TypeError):
            continue
        trials[trial.package, trial.seed, trial.name] = trial
    return list(trials.values())


def table(trials: list[Trial]) -> str:
    """Format a table with one row per package, and one for all."""
    packages: dict[str, list[Trial]] = defaultdict(list)
    for trial in trials:
        packages[trial.package].append(trial)
    rows = ["| package | caught | of | rate | 95 % interval |", "| --- | --- | --- | --- | --- |"]
    for name, held in [*packages.items(), ("all", trials)]:
        caught = sum(trial.caught for trial in held)
        low, high = interval(caught, len(held))
        share = caught / len(held)
        rows.append(f"| {name} | {caught} | {len(held)} | {share:.0%} | {low:.0%} to {high:.0%} |")
    return "\n".join(rows)
