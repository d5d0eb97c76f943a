"""Density of samples in the friction-speed plane as an image, computed once and cached."""

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
    """Images of the density of samples of some runs in the friction-speed plane.

    Attributes
    ----------
    frame
        Pixel grid of the images.
    places
        Pixel index of each sample of each run; one beyond the last index for samples outside.
    measured, model
        Images of the measured and the predicted friction (`Frame.picture`); `model` is None without
        a model.
    """

    frame: Frame
    places: Mapping[RunSeries, npt.NDArray[np.int32]]
    measured: str
    model: str | None

    def layer_of(self, masks: Mapping[RunSeries, Mask]) -> str:
        """Encoded image of the density of a subset of the samples, given by one mask per run."""
        return self.frame.picture([place[masks[run]] for run, place in self.places.items()])

    def to_dict(self) -> dict[str, Any]:
        """Data of the images for the page."""
        content: dict[str, Any] = {"frame": self.frame.to_dict(), "measured": self.measured}
        return content if self.model is None else {**content, "model": self.model}


@lru_cache(maxsize=8)
def density(runs: tuple[RunSeries, ...], size: Size) -> Density:
    """Compute the density of runs on a grid of at most `size` (columns, rows) pixels."""
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
    """Size of the grid for a number of samples, reduced if few, so that each is visible."""
    share = min(max((samples / DENSE) ** 0.5, LEAST_FINE), 1.0)
    return max(int(size[0] * share), 1), max(int(size[1] * share), 1)
