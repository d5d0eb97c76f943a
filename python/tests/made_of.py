"""Runs and samples put together by hand: what a function asks of a run, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
from jbf import Rig
from jbf.estimation.samples import Samples
from jbf.estimation.scales import Scales

Array = npt.NDArray[Any]
SIZES = Scales(
    whole_n=7.0,
    kinetic_n=5.0,
    viscous_n_s_m=20.0,
    breakaway_n=8.0,
    slow_m_s=0.01,
    usual_m_s=0.1,
    stroke_m=0.4,
    resolved_m=1e-6,
)
"""What data might say of themselves."""


class Recorded(SimpleNamespace):
    """A run of so many samples."""

    def __len__(self) -> int:
        return len(self.time_s)


def record(
    time: Array,
    *,
    name: str = "a",
    velocity: Array | None = None,
    way: Array | None = None,
    friction: Array | None = None,
    resting: Array | None = None,
    converter_step_n: float = 0.0,
) -> Any:
    """A run that is ready: at these times (s), in motion at 0.1 m/s unless told otherwise."""
    n = len(time)
    v = np.full(n, 0.1) if velocity is None else velocity
    at_rest = np.zeros(n, dtype=bool) if resting is None else resting.astype(bool)
    run = Recorded(
        name=name,
        time_s=time,
        duration_s=float(time[-1] - time[0]) if n else 0.0,
        quantities=Rig().quantities,
    )
    motion = SimpleNamespace(
        velocity_m_s=v,
        angle_rad=0.1 * time if way is None else way,
        resting=at_rest,
        sign_known=~at_rest,
    )
    return SimpleNamespace(
        run=run,
        motion=motion,
        friction_n=np.zeros(n) if friction is None else friction,
        step_s=float(np.median(np.diff(time))) if n > 1 else 0.02,
        converter_step_n=converter_step_n,
    )


def samples_of(
    prepared: Sequence[Any],
    counted: Sequence[Array] | None = None,
    weight: Sequence[Array] | None = None,
) -> Samples:
    """Samples of such runs that all count, each with a weight of one, unless told otherwise."""
    masks = tuple(
        np.ones(len(p.run.time_s), dtype=bool) if counted is None else counted[i].astype(bool)
        for i, p in enumerate(prepared)
    )
    return Samples(
        tuple(p.run.name for p in prepared),
        tuple(p.step_s for p in prepared),
        masks,
        tuple(m.astype(float) for m in masks) if weight is None else tuple(weight),
    )
