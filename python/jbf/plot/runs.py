"""Selection of the run to plot, and axis labels of a comparison."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from jbf.errors import InputError
from jbf.records.quantities import Quantities

if TYPE_CHECKING:
    from jbf.comparison.comparison import Comparison


def largest_error_run(comparison: Comparison, other: Comparison | None = None) -> int:
    """Index of the run with the largest error, or of the run in which two models differ most."""
    if other is None:
        return int(np.argmax([r.rms for r in comparison.runs]))
    gaps = [
        float(np.mean((a - b)[counted] ** 2))
        for a, b, counted in zip(
            comparison.predictions, other.predictions, comparison.samples.counted, strict=True
        )
    ]
    return int(np.argmax(gaps)) if max(gaps) > 0.0 else largest_error_run(comparison)


def index_of(comparison: Comparison, run: int | str | None) -> int:
    """Index of a run given by index or name; by default of that with the largest error.

    Raises
    ------
    InputError
        The comparison has no such run.
    """
    names = [r.name for r in comparison.runs]
    if run is None:
        return largest_error_run(comparison)
    if isinstance(run, str) and run in names:
        return names.index(run)
    if isinstance(run, int) and -len(names) <= run < len(names):
        return run % len(names)
    raise InputError(problem=f"run {run} does not exist", remedy=f"known: {', '.join(names)}")


def quantities_of(comparison: Comparison) -> Quantities:
    """Units and names of the quantities of a comparison's rig."""
    return comparison.model.rig.quantities


def axes_words(comparison: Comparison) -> tuple[str, str]:
    """Axis labels of speed and friction, with units."""
    quantities = quantities_of(comparison)
    return (
        f"{quantities.velocity} ({quantities.speed})",
        f"{quantities.friction} ({quantities.force})",
    )
