"""Conclusions that the motions of a campaign do not support, whatever model is fitted."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from jbf.diagnosis.policy import Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.scales import scales

LEVEL, STIFFNESS = "F_c", "sigma_0"


def limitations(
    campaign: Campaign, parameters: Mapping[str, float], policy: Policy
) -> tuple[str, ...]:
    """Describe each conclusion that the runs do not support, in one sentence each.

    Parameters
    ----------
    parameters
        Fitted values by name; those of a bristle give the presliding displacement.
    """
    said = campaign.rig.quantities
    speed = campaign.samples.flat([p.motion.velocity for p in campaign.prepared])
    if not len(speed):
        return ()
    found = []
    forward = float(np.mean(speed > 0.0))
    if min(forward, 1.0 - forward) < policy.limitations.min_reverse_share:
        found.append(
            "the motion has one direction: Coulomb friction and a constant load or offset have "
            "the same effect"
        )
    slow, fast = (float(q) for q in np.quantile(np.abs(speed), [0.05, 0.95]))
    span = f"{slow:.2g} to {fast:.2g} {said.speed}"
    if fast < policy.limitations.min_speed_ratio * slow:
        found.append(
            f"the speed hardly changes ({span}): Coulomb and viscous friction have the same effect"
        )
    elif fast < policy.limitations.wide_speed_ratio * slow:
        found.append(
            f"the speeds cover less than a decade ({span}): friction at other speeds is an "
            "extrapolation"
        )
    level, stiffness = (parameters.get(name) for name in (LEVEL, STIFFNESS))
    if level is not None and stiffness:
        bristle, stroke = level / stiffness, scales(campaign).stroke_m
        if stroke < policy.limitations.min_sliding * bristle:
            found.append(
                f"the strokes ({stroke:.2g} {said.length}) are hardly longer than the presliding "
                f"displacement ({bristle:.2g} {said.length}): the Coulomb level is an "
                "extrapolation"
            )
    return tuple(found)
