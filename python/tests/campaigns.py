"""Campaigns from the independent simulator (`simulator/rigsim`), which shares no code with jbf."""

from functools import cache
from typing import Any

from jbf import Rig, Run
from rigruns import simulated
from rigsim import Campaign
from rigsim.campaign import standard
from rigsim.motions import Motion

SHORT = standard("short")


@cache
def campaign(
    seed: int,
    effects: tuple[str, ...] = (),
    *,
    coloured: bool = False,
    foreign: tuple[str, ...] = (),
    strength: float = 1.0,
    motions: tuple[Motion, ...] = SHORT.motions,
    loads: tuple[tuple[str, float], ...] = (),
) -> tuple[Rig, list[Run], dict[str, Any]]:
    """A simulated campaign: rig, runs and true parameters."""
    return simulated(
        seed,
        effects,
        strength=strength,
        coloured=coloured,
        foreign=foreign,
        campaign=Campaign("short", motions, dict(loads)),
    )
