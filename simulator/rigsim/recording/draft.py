"""A record under construction, between the rig and the logger's file."""

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
"""Stages of a signal, in order.

The rig of this run; the sampling instants of each channel; the cell's zero and gain; its noise; the
converter; the transport in the logger; the encoder; the load; the rows of the file.
"""

Sizes = dict[str, float]


@dataclass(frozen=True)
class Signals:
    """The exact signals of a run at any instant; 0 s is the first sample of the record.

    `film_start` is None in a run that begins when its motion begins.
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
        """Force (N) including offset and drift of the cell; `times` (s) ascend."""
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
        """Surface speed (m/s)."""
        return commanded(self.motion, self._into_motion(times))[0]

    def angle(self, times: Vector) -> Vector:
        """Angle of the encoder (rad)."""
        position = commanded(self.motion, self._into_motion(times))[1]
        return self.start_angle_rad + position / self.base.bearing.radius_m


@dataclass
class Draft:
    """The current state of a run's record.

    `stamps` are the times written to the file, `instants` the true sampling instants of the
    encoder. `force_instants` are the true ones of the cell's converter, `force_stamps` those
    assumed by the logger (s). The force stays on its own instants until the transport stage maps it
    to the stamps. `unit` is noise of unit size, `scale` (N) its size, `extra` (N) additional noise.
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
        """Interval between stamps, s."""
        return float(self.stamps[1] - self.stamps[0])


@dataclass(frozen=True)
class Artefact:
    """An artefact of the recording.

    `draw` returns its sizes for a campaign from the ranges of a strength. `apply` applies it to a
    run and returns its sizes in this run. Each uses a separate generator.
    """

    name: str
    channel: str
    stage: Stage
    draw: Callable[[str, Rng], Sizes]
    apply: Callable[[Draft, Sizes, Rng], Sizes]
