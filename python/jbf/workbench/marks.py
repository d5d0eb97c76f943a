"""Marks on the plots where a model fails: the worst bin of each residual pattern."""

from __future__ import annotations

from typing import Any

import numpy as np

from jbf.comparison.axes import all_axes
from jbf.comparison.bins import labels
from jbf.comparison.comparison import Comparison
from jbf.comparison.patterns import Failure
from jbf.models.catalogue import transition_speed
from jbf.reporting.advice import advice_on
from jbf.workbench.thinning import ranges_of

ON_THE_PAGE = ("(--law auto)", "(Diagnose with the automatic law)")
"""Option of the command line in an advice, and what does the same on the page."""


def failure_marks(comparison: Comparison) -> list[dict[str, Any]]:
    """Description, causes, advice and worst intervals of each residual pattern, for the page.

    `ranges_s` maps the number of a run to pairs of instants, s.
    """
    model, campaign = comparison.model, comparison.campaign
    u_tr = transition_speed(model.law, model.values.tolist())
    binned = {axis.axis: axis for axis in all_axes(campaign, u_tr)}
    marks = []
    for failure in comparison.failures:
        advice = vars(advice_on(failure.axis, campaign))
        advice = {key: words.replace(*ON_THE_PAGE) for key, words in advice.items()}
        mark: dict[str, Any] = {**failure.to_dict(), **advice, "bin": "", "ranges_s": {}}
        axis = binned.get(failure.axis)
        if axis is not None:
            worst = worst_bin(failure)
            mark["bin"] = labels(failure.axis, failure.bins)[worst]
            for number, (p, places) in enumerate(zip(campaign.prepared, axis.places, strict=True)):
                time = p.run.time_s
                intervals_s = [(time[a], time[b - 1]) for a, b in ranges_of(places == worst)]
                if intervals_s:
                    mark["ranges_s"][str(number)] = [(float(a), float(b)) for a, b in intervals_s]
        marks.append(mark)
    return marks


def worst_bin(failure: Failure) -> int:
    """Index of the bin whose mean explains most of the mean square of the residual."""
    return int(np.argmax(failure.counts * failure.means_n**2))
