"""`--hold-out PATTERN`: runs that no fit uses, and the error of the model on these runs."""

from __future__ import annotations

from collections.abc import Sequence
from fnmatch import fnmatchcase
from textwrap import shorten
from typing import TYPE_CHECKING, Any

from jbf.errors import InputError
from jbf.records.checks import listed
from jbf.records.counts import count_of
from jbf.records.run import Run

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.models.model import Model

OPTION = "--hold-out"
WIDEST = 98
"""Maximum length of the list of errors by run, in characters."""


def add(parser: Parser) -> None:
    """Add the option `--hold-out`."""
    parser.add_argument(
        OPTION,
        metavar="PATTERN",
        action="append",
        default=[],
        help="exclude runs with matching names (wildcards * and ?) from all fits, and report the "
        "error of the model on them; may be repeated",
    )


def split(runs: Sequence[Run], patterns: Sequence[str]) -> tuple[list[Run], list[Run]]:
    """Split runs into those used for the fit and those held out, by the patterns of their names.

    Raises
    ------
    InputError
        A pattern matches no run, or the patterns match all runs.
    """
    for pattern in patterns:
        if not any(_fits(run, pattern) for run in runs):
            raise InputError(
                file=f"{OPTION} {pattern}",
                problem="matches no run",
                remedy=f"the runs are {listed(run.name for run in runs)}",
            )
    held_out = [run for run in runs if any(_fits(run, pattern) for pattern in patterns)]
    used = [run for run in runs if not any(_fits(run, pattern) for pattern in patterns)]
    if not used:
        raise InputError(
            file=f"{OPTION} {patterns[0]}",
            problem="matches every run",
            remedy="leave some runs for the fit",
        )
    return used, held_out


def _fits(run: Run, pattern: str) -> bool:
    """Whether the name or the file of a run matches a pattern."""
    names = [run.name] if run.path is None else [run.name, run.path.name, str(run.path)]
    return any(fnmatchcase(name, pattern) for name in names)


def error_for_json(model: Model, held_out: Sequence[Run]) -> dict[str, Any]:
    """Error of a model on the held-out runs, JSON-serialisable; empty without such runs.

    The data contain the total error and the error of each run.
    """
    if not held_out:
        return {}
    from jbf.comparison.compare import compare

    error = compare(model, held_out).to_dict()
    return {"hold_out": {key: error[key] for key in ("rms", "noise_rms", "runs")}}


def words(model: Model, error: dict[str, Any]) -> list[str]:
    """Lines that report the error of a model on the held-out runs."""
    if not error:
        return []
    from jbf.reporting.words import against_noise

    held_out = error["hold_out"]
    unit = model.rig.quantities.force
    ratio = against_noise(held_out["rms"], held_out["noise_rms"] or 0.0)
    runs = ", ".join(f"{run['run']} {run['rms']:.3g}" for run in held_out["runs"])
    return [
        "",
        f"Held out ({count_of(len(held_out['runs']), 'run')}, excluded from all fits): RMS "
        f"{held_out['rms']:.4g} {unit}, {ratio}",
        f"  {shorten(runs, WIDEST, placeholder=' ...')}",
    ]
