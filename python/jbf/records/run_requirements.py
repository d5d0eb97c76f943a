"""Check that a run has required columns, and the quantities of its rig."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from jbf.errors import InputError
from jbf.records.checks import listed
from jbf.records.quantities import BEARING
from jbf.records.run import Run

if TYPE_CHECKING:
    from jbf.records.rig import Rig


def require(run: Run, columns: str | Iterable[str], why: str) -> None:
    """Raise a one-line error if a run lacks a required column.

    Parameters
    ----------
    columns : str or iterable of str
        Column names, for example ``"angle_rad"``.
    why : str
        The part that requires the column, as a subject: ``"the effect position_ripple"``.

    Raises
    ------
    InputError
        A column is missing.
    """
    available = run.columns()
    for column in [columns] if isinstance(columns, str) else columns:
        if column not in available:
            raise InputError(
                file=run.path or run.name,
                column=column,
                problem=f"is missing, and {why} needs it",
                remedy=f"add the column (it has {listed(available)})",
            )


def run_on(rig: Rig, run: Run) -> Run:
    """Return the run with the units of its rig, after a check that both belong together.

    Raises
    ------
    InputError
        The run was read for another kind of machine, or without the rig that its columns require.
    """
    quantities = rig.quantities
    if run.quantities == quantities:
        return run
    if run.quantities != BEARING and run.quantities.motion != quantities.motion:
        raise InputError(
            file=run.path or run.name,
            problem=f"was read for a {run.quantities.motion} drive, but the rig is not one",
            remedy="give the rig with which it was read",
        )
    if run.quantities == BEARING and quantities.motion == "rotary" and run.path is not None:
        raise InputError(
            file=run.path,
            problem="was read without the rig, whose [drive] defines its columns",
            remedy="read it with the rig: jbf.read_run(path, rig)",
        )
    return replace(run, quantities=quantities)
