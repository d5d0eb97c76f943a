"""Structure at isolated instants: innovations larger than any noise of that size shows."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.result import Remainder
from jbf.estimation.fit import Problem

Array = npt.NDArray[np.float64]

FAR_SIGMA = 5.0
"""An innovation beyond this is one in two millions of Gaussian noise."""
MOST_BY_CHANCE = 2
"""So few of them are let pass."""
LEAST_SHARE = 0.008
"""Share of the mean square below which they do not matter."""
APART_S = 0.5
"""Large innovations closer than this are one burst."""
NAMED = 4
"""Bursts named in the description."""


def find_bursts(problem: Problem, innovations: list[Array]) -> list[Remainder]:
    """Isolated bursts in the innovations (record minus prediction), if there are any."""
    prepared = problem.campaign.prepared
    every = np.concatenate([e[p.trusted] for e, p in zip(innovations, prepared, strict=True)])
    if not len(every):
        return []
    # The middle of the distribution: bursts must not hide behind the spread that they cause.
    sigma = float(np.median(np.abs(every))) / 0.6745
    far = np.abs(every) > FAR_SIGMA * sigma
    square = float(every @ every)
    share = float(np.sum(every[far] ** 2)) / max(square, 1e-300)
    if int(far.sum()) <= MOST_BY_CHANCE or share < LEAST_SHARE:
        return []
    bursts: list[tuple[float, float, str]] = []
    for e, p in zip(innovations, prepared, strict=True):
        index = np.flatnonzero((np.abs(e) > FAR_SIGMA * sigma) & p.trusted)
        time = p.run.time_s[index]
        for group in np.split(index, np.flatnonzero(np.diff(time) > APART_S) + 1):
            if len(group):
                top = int(group[np.argmax(np.abs(e[group]))])
                bursts.append((abs(float(e[top])), float(p.run.time_s[top]), p.run.name))
    bursts.sort(reverse=True)
    largest = ", ".join(f"{time:.1f} s in {name}" for _, time, name in bursts[:NAMED])
    where = f"{len(bursts)} bursts, the largest {bursts[0][0]:.2g} N: at {largest}"
    return [Remainder("time", where, min(share, 1.0))]
