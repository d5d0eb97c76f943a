"""Runs beyond the range of all others, and alternate parts of a run for held-out tests.

The prediction of a fast run from slower ones is an extrapolation. Its error depends on the form
of the law more than on the fit, and is not a held-out error. Such a run, and a single run, is
tested on alternate parts of itself, which contain the same kinds of motion as the fitted parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign
from jbf.estimation.settings import HeldOutSettings
from jbf.records.recorded_load import recorded_load

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Beyond:
    """A run that is beyond the range of all others.

    Attributes
    ----------
    run
        Index of the run in the campaign.
    quantity
        `speed` (with its sign, so also the only run in one direction) or `load`.
    value, others
        Extreme value of this run, and the nearest one of the other runs, in the unit of the record.
    """

    run: int
    quantity: str
    value: float
    others: float


def alternate_parts(count: int, parts: int) -> Mask:
    """Mask of the first, third, ... of a number of equal parts of a run, shape (count,)."""
    found: Mask = (np.arange(count) * parts // max(count, 1)) % 2 == 0
    return found


def runs_beyond(campaign: Campaign) -> list[Beyond]:
    """Runs that are beyond the range of all others, each with the first such quantity."""
    found: dict[int, Beyond] = {}
    for quantity, values in _quantities(campaign).items():
        for beyond in _beyond(quantity, values, campaign.settings.held_out):
            found.setdefault(beyond.run, beyond)
    return [found[run] for run in sorted(found)]


def _quantities(campaign: Campaign) -> dict[str, list[Array]]:
    """Speed and load at the samples that count, one array a run."""
    runs, counted = campaign.prepared, campaign.samples.counted
    speeds = [p.motion.velocity[c] for p, c in zip(runs, counted, strict=True)]
    loads = [recorded_load(p.rig, p.run) for p in runs]
    known = [load[c] for load, c in zip(loads, counted, strict=True) if load is not None]
    return {"speed": speeds} | ({"load": known} if len(known) == len(runs) else {})


def _beyond(quantity: str, values: list[Array], settings: HeldOutSettings) -> list[Beyond]:
    top = max((float(np.max(np.abs(v), initial=0.0)) for v in values), default=0.0)
    margin, found = settings.extrapolation_margin * top, []
    for run, own in enumerate(values):
        rest = [v for other, v in enumerate(values) if other != run and len(v)]
        if not len(own) or not rest:
            continue
        low, high = min(float(v.min()) for v in rest), max(float(v.max()) for v in rest)
        for outside, value, others in (
            (own > high + margin, float(own.max()), high),
            (own < low - margin, float(own.min()), low),
        ):
            if np.mean(outside) > settings.extrapolation_share:
                found.append(Beyond(run, quantity, value, others))
    return found
