"""Campaigns of the independent simulator as jbf reads them: the one place where the two meet."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import jbf
import rigsim
from rigsim.warmth import REFERENCE_C


def simulated(
    seed: int, effects: tuple[str, ...] = (), **options: Any
) -> tuple[jbf.Rig, list[jbf.Run], dict[str, Any]]:
    """A simulated campaign: the rig, its runs, and the truth behind them.

    `options` are those of `rigsim.simulate_campaign`.
    """
    records, truth = rigsim.simulate_campaign(seed, effects, **options)
    rig = rig_of(truth["base"]["load_n"])
    if any(r.temperature_c is not None for r in records.values()):
        # The viscosity holds at a temperature, and who has a thermometer knows at which.
        assert rig.lubricant is not None
        oil = replace(rig.lubricant, temperature_c=REFERENCE_C)
        rig = replace(rig, lubricant=oil)
    return rig, runs_of(records), truth


def runs_of(records: dict[str, rigsim.Record]) -> list[jbf.Run]:
    """Simulated records as runs."""
    return [
        jbf.Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.friction_n,
            angle_rad=r.angle_rad,
            load_n=r.load_n,
            temperature_c=r.temperature_c,
            name=name,
        )
        for name, r in records.items()
    ]


def rig_of(load_n: float) -> jbf.Rig:
    """The rig of a load that the simulator drew."""
    return jbf.Rig.thesis("4.2" if load_n == 104.0 else "4.3")
