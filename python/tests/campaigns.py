"""Campaigns from the independent simulator (`simulator/rigsim`), which shares no code with jbf."""

from __future__ import annotations

from functools import cache
from typing import Any

from jbf import Rig, Run
from rigsim import Campaign, simulate_campaign
from rigsim.motions import Motion, sine, stop_and_go

SHORT = Campaign(
    "short",
    (
        sine("two_way_0.25", 50.3, 0.127, 0.25),
        sine("two_way_1", 25.2, 0.127, 1.0),
        sine("two_way_2", 18.9, 0.127, 2.0),
        sine("one_way_0.5", 25.2, 0.0595, 0.5, bias=0.0728),
        stop_and_go("stop_and_go", [(1.0, 1), (9.0, -1), (22.0, 1)], 0.055, 0.8, 3.5, 30.0),
    ),
)


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
    """A rig, its runs, and the truth behind them."""
    records, truth = simulate_campaign(
        seed,
        effects,
        strength=strength,
        coloured=coloured,
        foreign=foreign,
        campaign=Campaign("short", motions, dict(loads)),
    )
    rig = Rig.thesis("4.2" if truth["base"]["load_n"] == 104.0 else "4.3")
    runs = [
        Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.friction_n,
            angle_rad=r.angle_rad,
            load_n=r.load_n,
            name=name,
        )
        for name, r in records.items()
    ]
    return rig, runs, truth
