"""Density of samples in the friction-speed plane, computed once and cached."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.workbench.plane import Frame
from jbf.workbench.series import RunSeries

Mask = npt.NDArray[np.bool_]
Size = tuple[int, int]
DENSE = 100_000
"""Number of samples from which the plane is drawn at full resolution."""
LEAST_FINE = 0.35
"""Minimum resolution along each axis, as a share of full resolution."""


@dataclass(frozen=True, eq=False)
class Density:
    """Density of some runs in the friction-speed plane.

    Attributes
    ----------
    places
        Pixel index of each sample of each run; one beyond the last index for samples outside.
    measured, model
        Encoded images; `model` is None without a model.
    """

    frame: Frame
    places: Mapping[RunSeries, npt.NDArray[np.int32]]
    measured: str
    model: str | None

    def layer_of(self, masks: Mapping[RunSeries, Mask]) -> str:
        """Return the image of a subset of the samples."""
        return self.frame.picture([place[masks[run]] for run, place in self.places.items()])

    def to_dict(self) -> dict[str, Any]:
        """Return the data for the page."""
        content: dict[str, Any] = {"frame": self.frame.to_dict(), "measured": self.measured}
        return content if self.model is None else {**content, "model": self.model}


@lru_cache(maxsize=8)
def density(runs: tuple[RunSeries, ...], size: Size) -> Density:
    """Compute the density of runs with at most the given number of columns and rows."""
    measured = {run: run.friction for run in runs if run.friction is not None}
    models = [run.model_n for run in measured if run.model_n is not None]
    speeds = [run.velocity for run in measured]
    fine = pixels_for(sum(map(len, speeds)), size)
    frame = Frame.around(speeds, [*measured.values(), *models], *fine)
    places = {run: frame.places(run.velocity, force) for run, force in measured.items()}
    model = None
    if models and len(models) == len(measured):
        parts = zip(speeds, models, strict=True)
        model = frame.picture([frame.places(speed, force) for speed, force in parts])
    return Density(frame, places, frame.picture(list(places.values())), model)


def pixels_for(samples: int, size: Size) -> Size:
    """Reduce the number of pixels for few samples, so that a single one is visible."""
    share = min(max((samples / DENSE) ** 0.5, LEAST_FINE), 1.0)
    return max(int(size[0] * share), 1), max(int(size[1] * share), 1)
