"""Density of samples in the friction-speed plane as an image, computed once and cached."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Mask
from jbf.workbench.plane import Frame
from jbf.workbench.series import RunSeries

Places = npt.NDArray[np.int32]
Size = tuple[int, int]
DENSE = 100_000
"""Number of samples from which the plane is drawn at full resolution."""
MOST_UNUSED = 900
"""Maximum number of pixels that are marked as not used by the fit."""
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
        a model. With a model, `measured` contains the samples that its fit uses.
    unused
        Pixels (column, row) with samples that the fit does not use, at most `MOST_UNUSED`.
    """

    frame: Frame
    places: Mapping[RunSeries, Places]
    measured: str
    model: str | None
    unused: list[tuple[int, int]]

    def layer_of(self, masks: Mapping[RunSeries, Mask]) -> str:
        """Encoded image of the density of a subset of the samples, given by one mask per run."""
        return self.frame.picture([place[masks[run]] for run, place in self.places.items()])

    def to_dict(self) -> dict[str, Any]:
        """Data of the images for the page."""
        content: dict[str, Any] = {
            "frame": self.frame.to_dict(),
            "measured": self.measured,
            "unused": self.unused,
        }
        return content if self.model is None else {**content, "model": self.model}


@lru_cache(maxsize=8)
def density(runs: tuple[RunSeries, ...], size: Size, axis: str = "speed") -> Density:
    """Compute the density of runs on a grid of at most `size` (columns, rows) pixels.

    `axis` is the horizontal axis, `speed` or `position`; runs without it are omitted.
    """
    measured = {
        run: (across, run.friction)
        for run in runs
        if run.friction is not None and (across := run.across(axis)) is not None
    }
    models = [run.model_n for run in measured if run.model_n is not None]
    along = [across for across, _ in measured.values()]
    forces = [force for _, force in measured.values()]
    fine = pixels_for(sum(map(len, along)), size)
    frame = Frame.around(along, [*forces, *models], *fine)
    places = {run: frame.places(across, force) for run, (across, force) in measured.items()}
    model = None
    if models and len(models) == len(measured):
        parts = zip(along, models, strict=True)
        model = frame.picture([frame.places(across, force) for across, force in parts])
    used, unused = _by_use(places)
    return Density(frame, places, frame.picture(used), model, _pixels(frame, unused))


def _by_use(places: Mapping[RunSeries, Places]) -> tuple[list[Places], list[Places]]:
    """Pixel indices of the samples that a fit uses, and of the others; without a model, all."""
    used, unused = [], []
    for run, place in places.items():
        counted = None if run.counted is None else run.counted > 0
        used.append(place if counted is None else place[counted])
        if counted is not None:
            unused.append(place[~counted])
    return used, unused


def _pixels(frame: Frame, places: list[Places]) -> list[tuple[int, int]]:
    """Column and row of each pixel with a sample, thinned to at most `MOST_UNUSED`."""
    if not places:
        return []
    inside = np.unique(np.concatenate(places))
    inside = inside[inside < frame.rows * frame.columns]
    inside = inside[:: max(-(-len(inside) // MOST_UNUSED), 1)]
    return [(int(i % frame.columns), int(i // frame.columns)) for i in inside]


def pixels_for(samples: int, size: Size) -> Size:
    """Size of the grid for a number of samples, reduced if few, so that each is visible."""
    share = min(max((samples / DENSE) ** 0.5, LEAST_FINE), 1.0)
    return max(int(size[0] * share), 1), max(int(size[1] * share), 1)
