"""The stroke of a drive: where its runs go, and a little beyond."""

from __future__ import annotations

import numpy as np

from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import moving_samples

SHORTEST_M = 1e-9
"""A stroke is no shorter: a drive that stands has none to speak of."""
BEYOND = 0.1
"""Share of the way of the runs by which the stroke goes on beyond either end: waves whose slope
vanishes at its ends then say a slope at the runs'."""


def stroke(campaign: Campaign) -> tuple[float, float]:
    """The lowest and the highest place of a campaign's stroke, m (of a joint rad).

    The motion tells it, and not the force: runs that are left out of a fit give nothing away by it.
    """
    arm = 1.0 if campaign.rig.bearing is None else campaign.rig.bearing.radius_m
    pairs = zip(campaign.prepared, moving_samples(campaign), strict=True)
    places = np.concatenate([p.motion.angle_rad[moving] for p, moving in pairs]) * arm
    if not len(places):
        return -SHORTEST_M, SHORTEST_M
    low, high = float(np.min(places)), float(np.max(places))
    more = max(BEYOND * (high - low), SHORTEST_M)
    return low - more, high + more
