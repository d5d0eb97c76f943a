"""Stroke of a drive: the travel of its runs with a margin."""

from __future__ import annotations

import numpy as np

from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import moving_samples

SHORTEST_M = 1e-9
"""Shortest stroke, m; used for a drive that does not move. It is a numerical tolerance."""
BEYOND = 0.1
"""Margin of the stroke at either end, as a fraction of the travel of the runs.

Waves whose slope vanishes at the ends of the stroke can then describe a slope at those of the runs.
It defines an effect, not a criterion.
"""


def stroke(campaign: Campaign) -> tuple[float, float]:
    """Lowest and highest position of a campaign's stroke, m (rad for a joint).

    They are computed from the motion and not from the force, so no information on held-out forces
    is used.
    """
    arm = 1.0 if campaign.rig.bearing is None else campaign.rig.bearing.radius_m
    pairs = zip(campaign.prepared, moving_samples(campaign), strict=True)
    places = np.concatenate([p.motion.angle_rad[moving] for p, moving in pairs]) * arm
    if not len(places):
        return -SHORTEST_M, SHORTEST_M
    low, high = float(np.min(places)), float(np.max(places))
    more = max(BEYOND * (high - low), SHORTEST_M)
    return low - more, high + more
