"""`--hold-out PATTERN`: runs that no fit sees, and what the model then leaves on them."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from jbf.errors import InputError
from jbf.records.checks import listed
from jbf.records.counts import count_of
from jbf.records.run import Run

if TYPE_CHECKING:
    from jbf.cli import Parser
    from jbf.models.model import Model

OPTION = "--hold-out"


def add(parser: Parser) -> None:
    """The option."""
    parser.add_argument(
        OPTION,
        metavar="PATTERN",
        action="append",
        default=[],
        help="use runs with such names (*, ?) for nothing but the error that the model leaves on "
        "them; may be repeated",
    )


def split(runs: Sequence[Run], asked: argparse.Namespace) -> tuple[list[Run], list[Run]]:
    """The runs to use, and those held out.

    Raises
    ------
    InputError
        A pattern fits no run, or the patterns fit all of them.
    """
    patterns: list[str] = asked.hold_out
    for pattern in patterns:
        if not any(_fits(run, pattern) for run in runs):
            raise InputError(
                file=f"{OPTION} {pattern}",
                problem="fits no run",
                mend=f"there are {listed(run.name for run in runs)}",
            )
    held = [run for run in runs if any(_fits(run, pattern) for pattern in patterns)]
    used = [run for run in runs if not any(_fits(run, pattern) for pattern in patterns)]
    if not used:
        raise InputError(
            file=f"{OPTION} {patterns[0]}", problem="fits every run", mend="leave some to be fitted"
        )
    return used, held


def _fits(run: Run, pattern: str) -> bool:
    names = [run.name] if run.path is None else [run.name, run.path.name, str(run.path)]
    return any(fnmatchcase(name, pattern) for name in names)


def left(model: Model, held: Sequence[Run]) -> dict[str, Any]:
    """For JSON: what a model leaves on the runs held out; nothing where there are none."""
    if not held:
        return {}
    from jbf.comparison.comparison import compare

    told = compare(model, held).to_dict()
    return {"hold_out": {key: told[key] for key in ("rms_n", "noise_n", "runs")}}


def words(model: Model, told: dict[str, Any]) -> str:
    """The same for people."""
    if not told:
        return ""
    from jbf.reporting.words import against_noise

    found = told["hold_out"]
    unit = model.rig.quantities.force
    ratio = against_noise(found["rms_n"], found["noise_n"] or 0.0)
    runs = ", ".join(f"{run['run']} {run['rms_n']:.3g}" for run in found["runs"])
    return (
        f"\n\nHeld out ({count_of(len(found['runs']), 'run')}, used for nothing else): RMS "
        f"{found['rms_n']:.4g} {unit}, {ratio}"
        f"\n  {runs}"
    )
