"""Plot of the candidates of one selection step, ranked by evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from jbf.errors import InputError
from jbf.models.number_format import BASE_LAW
from jbf.plot.style import BEFORE, INK, MEASURED, MODEL, NOISE, dress, one_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from jbf.diagnosis.ledger import Step, Trial
    from jbf.diagnosis.result import Diagnosis

MOST = 12
FEWEST = 3
LINEAR = 10.0
"""Evidence up to which the axis is linear; beyond it the axis is logarithmic."""
COLOURS = {"added": MODEL, "ties": NOISE, "rejected": BEFORE}


def _shown(trials: Sequence[Trial]) -> Sequence[Trial]:
    """Candidates to plot: those with evidence, at least `FEWEST` and at most `MOST`."""
    return trials[: min(max(sum(t.evidence > 0.0 for t in trials), FEWEST), MOST)]


def ranking_height(step: Step) -> float:
    """Height of a figure of the candidates of a step, inches."""
    return 1.2 + 0.27 * len(_shown(sorted(step.trials, key=lambda t: -t.evidence)))


def ranking(diagnosis: Diagnosis, step: int = 0, *, ax: Axes | None = None) -> Axes:
    """Plot the candidates of one step of a diagnosis by evidence, strongest first.

    Long lists are truncated.

    Parameters
    ----------
    step
        Index into `diagnosis.steps`. Default: the step of the base law.

    Raises
    ------
    InputError
        There is no such step, or the step has no candidates.
    """
    if not -len(diagnosis.steps) <= step < len(diagnosis.steps):
        raise InputError(
            problem=f"step {step} does not exist",
            remedy=f"choose one of {len(diagnosis.steps)} steps",
        )
    ledger_step = diagnosis.steps[step]
    trials = sorted(ledger_step.trials, key=lambda t: -t.evidence)
    if not trials:
        raise InputError(
            problem=f"no candidates were tested at step {step}", remedy="choose an earlier step"
        )
    listed = _shown(trials)
    ax = one_axes(ax, (7.0, ranking_height(ledger_step)))
    y = np.arange(len(listed))
    values = [t.evidence for t in listed]
    colours = [COLOURS.get(t.outcome, MEASURED) for t in listed]
    ax.barh(y, values, color=colours, height=0.62)
    ax.axvline(0.0, color=INK, linewidth=0.8)
    ax.set_xscale("symlog", linthresh=LINEAR)
    ax.set_yticks(y, labels=[t.effect for t in listed], fontsize="small")
    ax.set_ylim(len(listed) - 0.4, -0.6)
    low, high = min(*values, 0.0, -LINEAR), max(*values, 0.0, LINEAR)
    ax.set_xlim(1.3 * low, 12.0 * high)
    for at, t in enumerate(listed):
        ax.annotate(
            f"{t.evidence:+.0f}  {t.outcome}".replace("-", "−"),
            (max(t.evidence, 0.0), at),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize="x-small",
        )
    rest = len(trials) - len(listed)
    more = f"; {rest} with less evidence omitted" if rest else ""
    model_text = " + ".join([BASE_LAW, *ledger_step.effects])
    dress(ax, f"Candidates added to the {model_text}{more}", "Evidence", "")
    return ax
