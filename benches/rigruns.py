"""Campaigns of the independent simulator as jbf reads them: the one place where the two meet."""

from __future__ import annotations

import jbf
import rigsim


def runs_of(records: dict[str, rigsim.Record]) -> list[jbf.Run]:
    """Simulated records as runs."""
    return [
        jbf.Run.from_arrays(
            r.time_s,
            r.velocity_m_s,
            r.friction_n,
            angle_rad=r.angle_rad,
            load_n=r.load_n,
            name=name,
        )
        for name, r in records.items()
    ]


def rig_of(load_n: float) -> jbf.Rig:
    """The rig of a load that the simulator drew."""
    return jbf.Rig.thesis("4.2" if load_n == 104.0 else "4.3")
