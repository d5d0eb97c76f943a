"""Time series of a run for the plots: the record as read, or with a model's prediction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.records.run import Run
from jbf.workbench.thinning import stretch_of, thinned

DIGITS = 6
TIME_DIGITS = 11
"""Significant digits of times: one day in microseconds."""


@dataclass(frozen=True, eq=False)
class RunSeries:
    """Time series of one run, compared by identity.

    Attributes
    ----------
    time_s, velocity, friction
        Time, s, and speed and friction in the units of the rig, shape (n,).
    model_n
        Predicted friction; None without a model.
    counted
        True at included samples; None without a model.
    position
        Position or angle of the run; None if it was not recorded.
    """

    time_s: Array
    velocity: Array
    friction: Array | None
    model_n: Array | None = None
    counted: Array | None = None
    position: Array | None = None

    @cached_property
    def residual_n(self) -> Array | None:
        """Record minus prediction, in the unit of the rig.

        NaN at excluded samples; None without a model.
        """
        if self.model_n is None or self.friction is None or self.counted is None:
            return None
        return np.where(self.counted > 0, self.friction - self.model_n, np.nan)

    def across(self, axis: str) -> Array | None:
        """Values on the horizontal axis of the plane: `speed` or `position`."""
        return self.position if axis == "position" else self.velocity

    def columns(self) -> dict[str, Array]:
        """Available time series by name."""
        candidates: dict[str, Array | None] = {
            "velocity_m_s": self.velocity,
            "friction_n": self.friction,
            "model_n": self.model_n,
            "residual_n": self.residual_n,
        }
        if self.counted is not None and self.friction is not None:
            candidates["unused"] = np.where(self.counted > 0, np.nan, self.friction)
        return {name: values for name, values in candidates.items() if values is not None}


@lru_cache(maxsize=512)
def as_read(run: Run) -> RunSeries:
    """Time series of a run as in its file."""
    speed = run.velocity
    path = run.position_m if run.position_m is not None else run.angle_rad
    if not np.any(np.isfinite(speed)):
        speed = np.zeros(len(run)) if path is None else np.gradient(path, run.time_s)
    return RunSeries(run.time_s, speed, run.friction, position=path)


@lru_cache(maxsize=512)
def as_modelled(file: Path) -> RunSeries:
    """Time series of a run with a model's prediction, from the file written by the fit."""
    rows = map(np.asarray, np.load(file, mmap_mode="r"))
    time, speed, friction, model, counted, position = rows
    return RunSeries(time, speed, friction, model, counted, position)


def drawn(data: RunSeries, from_s: float | None, to_s: float | None, pixels: int) -> dict[str, Any]:
    """Time series of an interval of a run, reduced to the resolution of a plot."""
    stretch = stretch_of(data.time_s, (from_s, to_s), pixels)
    reduced = thinned(data.time_s, data.columns(), stretch)
    return {
        "samples": len(data.time_s),
        "from_s": float(data.time_s[0]),
        "to_s": float(data.time_s[-1]),
        "stride": stretch.stride,
        **{name: listed(values, TIME_DIGITS if name == "time_s" else DIGITS)
           for name, values in reduced.items()},
    }  # fmt: skip


def listed(values: Sequence[float] | Array, digits: int = DIGITS) -> list[float | None]:
    """Round values to the displayed precision for JSON; non-finite values become None.

    `digits` is the number of significant digits.
    """
    array = np.asarray(values, dtype=float)
    finite = np.isfinite(array)
    scale = float(np.max(np.abs(array[finite]), initial=0.0)) or 1.0
    decimals = digits - 1 - int(np.floor(np.log10(scale)))
    # Beyond this range numpy's rounding factor is not finite.
    rounded = np.round(array, decimals) if abs(decimals) < 200 else array
    if finite.all():
        return rounded.tolist()  # type: ignore[no-any-return]
    return [v if ok else None for v, ok in zip(rounded.tolist(), finite.tolist(), strict=True)]
