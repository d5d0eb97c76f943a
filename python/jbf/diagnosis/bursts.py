"""Structure at isolated instants: innovations larger than any noise of that size shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import Policy
from jbf.estimation.prepared import Prepared
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]

APART_S = 0.5
"""Large innovations closer than this are one burst."""
NAMED = 4
"""Bursts named in the description."""


def find_bursts(
    prepared: Sequence[Prepared], samples: Samples, innovations: Sequence[Array], policy: Policy
) -> list[Remainder]:
    """Isolated bursts in the innovations (record minus prediction), if there are any."""
    every = samples.flat(innovations)
    if not len(every):
        return []
    # The middle of the distribution: bursts must not hide behind the spread that they cause.
    sigma = float(np.median(np.abs(every))) / 0.6745
    far = np.abs(every) > policy.burst_sigma * sigma
    square = float(every @ every)
    share = float(np.sum(every[far] ** 2)) / max(square, 1e-300)
    if int(far.sum()) <= policy.bursts_by_chance or share < policy.burst_share:
        return []
    bursts: list[tuple[float, float, str]] = []
    for e, counted, p in zip(innovations, samples.counted, prepared, strict=True):
        index = np.flatnonzero((np.abs(e) > policy.burst_sigma * sigma) & counted)
        time = p.run.time_s[index]
        for group in np.split(index, np.flatnonzero(np.diff(time) > APART_S) + 1):
            if len(group):
                top = int(group[np.argmax(np.abs(e[group]))])
                bursts.append((abs(float(e[top])), float(p.run.time_s[top]), p.run.name))
    bursts.sort(reverse=True)
    largest = ", ".join(f"{time:.1f} s in {name}" for _, time, name in bursts[:NAMED])
    where = f"{len(bursts)} bursts, the largest {bursts[0][0]:.2g} N: at {largest}"
    return [Remainder("time", where, min(share, 1.0))]
