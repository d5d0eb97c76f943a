"""Record of a run between the exact signals of the rig and the file of the logger."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..bearing import Base
from ..instrument import read_out
from ..lubricant import Parameters
from ..motions import Motion
from ..record import Vector
from ..seeds import Rng
from ..simulate import cell_force, commanded

Stage = Literal["rig", "clock", "cell", "noise", "converter", "transport", "motion", "load", "rows"]
STAGES: tuple[Stage, ...] = (
    "rig",
    "clock",
    "cell",
    "noise",
    "converter",
    "transport",
    "motion",
    "load",
    "rows",
)
"""Stages of a recording, in the order in which they act.

They are the rig of this run, the sampling instants of each channel, zero and gain of the load cell,
its noise, the converter, the transport in the logger, the encoder, the load, and the rows of the
file.
"""

Sizes = dict[str, float]


@dataclass(frozen=True)
class Signals:
    """Exact signals of a run at any instant; the first sample of the record is at 0 s.

    `film_start` is None in a run that begins with its motion.
    """

    base: Base
    effects: Parameters
    motion: Motion
    begins_s: float
    start_angle_rad: float
    film_start: tuple[float, float] | None

    def _into_motion(self, times: Vector) -> Vector:
        return np.clip(times + self.begins_s, 0.0, self.motion.duration_s)

    def force(self, times: Vector) -> Vector:
        """Return the force (N) with offset and drift of the load cell at `times` (s, ascending)."""
        force = cell_force(
            self.base,
            self.effects,
            self.motion,
            self._into_motion(times),
            self.start_angle_rad,
            self.film_start,
        )
        return read_out(force, times, self.effects)

    def speed(self, times: Vector) -> Vector:
        """Return the surface speed at `times` (s), m/s."""
        return commanded(self.motion, self._into_motion(times))[0]

    def angle(self, times: Vector) -> Vector:
        """Return the angle of the encoder at `times` (s), rad."""
        position = commanded(self.motion, self._into_motion(times))[1]
        return self.start_angle_rad + position / self.base.bearing.radius_m


@dataclass
class Draft:
    """Record of a run to which the artefacts are applied in turn.

    `stamps` are the times written to the file, `instants` the true sampling instants of the
    encoder. `force_instants` are the true sampling instants of the force, and `force_stamps` those
    that the logger assumes (s). The force has its own instants until the transport stage maps it to
    the stamps. `unit` is noise of unit size, `scale` its size (N), and `extra` additional noise
    (N).
    """

    signals: Signals
    stamps: Vector
    noise_n: float
    peak_n: float
    counts_per_rad: float
    instants: Vector = field(init=False)
    force_instants: Vector = field(init=False)
    force_stamps: Vector = field(init=False)
    held: bool = False
    force: Vector = field(init=False)
    clean: Vector = field(init=False)
    unit: Vector = field(init=False)
    scale: Vector = field(init=False)
    extra: Vector = field(init=False)
    speed: Vector = field(init=False)
    angle: Vector = field(init=False)
    load: Vector = field(init=False)
    rows: NDArray[np.intp] = field(init=False)

    @property
    def step_s(self) -> float:
        """Interval between the first two time stamps, s."""
        return float(self.stamps[1] - self.stamps[0])


@dataclass(frozen=True)
class Artefact:
    """Artefact of the recording, with functions to draw its size and to apply it.

    `draw` returns its sizes for a campaign from the ranges of a strength. `apply` applies it to a
    run and returns its sizes in this run. Each uses a separate generator.
    """

    name: str
    channel: str
    stage: Stage
    draw: Callable[[str, Rng], Sizes]
    apply: Callable[[Draft, Sizes, Rng], Sizes]
