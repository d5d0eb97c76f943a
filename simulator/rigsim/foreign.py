"""Effects that are in no catalogue, to see whether a diagnosis admits "unexplained".

Each is drawn once a campaign and alters the noise-free record of every run. `apply` takes the
record's time (s), angle (rad), speed (m/s) and force (N), and gives the force changed.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import ClassVar, Protocol

import numpy as np

from .record import Vector

Rng = np.random.Generator


class Foreign(Protocol):
    """What every foreign effect offers."""

    name: ClassVar[str]

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        """The force (N) with the effect in it; `rng` is the run's own."""


@dataclass(frozen=True)
class Hum:
    """A tone of fixed frequency, its phase new in each run."""

    name: ClassVar[str] = "hum"
    amplitude_n: float
    frequency_hz: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Hum:
        return cls(strength * rng.uniform(0.4, 0.9), rng.uniform(2.0, 8.0))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        phase = rng.uniform(0.0, 2.0 * math.pi)
        return force + self.amplitude_n * np.sin(2.0 * math.pi * self.frequency_hz * time + phase)


@dataclass(frozen=True)
class Cogging:
    """Motor cross-talk at a higher harmonic of the angle, added to friction."""

    name: ClassVar[str] = "cogging"
    amplitude_n: float
    harmonic: int
    angle_rad: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Cogging:
        amplitude, harmonic = strength * rng.uniform(0.5, 1.0), int(rng.integers(2, 7))
        return cls(amplitude, harmonic, rng.uniform(0.0, 2.0 * math.pi))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        return force + self.amplitude_n * np.cos(self.harmonic * (angle - self.angle_rad))


@dataclass(frozen=True)
class Backlash:
    """Play in the force path: the record follows the force only at the ends of a gap."""

    name: ClassVar[str] = "backlash"
    half_width_n: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Backlash:
        return cls(strength * rng.uniform(0.6, 1.3))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        out = np.empty(len(force))
        held = float(force[0])
        for i, f in enumerate(force.tolist()):
            held = min(max(held, f - self.half_width_n), f + self.half_width_n)
            out[i] = held
        return out


@dataclass(frozen=True)
class LevelStep:
    """Friction changes by a share at one instant of every run."""

    name: ClassVar[str] = "level_step"
    share: float
    instant: float  # as a share of the run's length

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> LevelStep:
        sign = 1.0 if rng.random() < 0.5 else -1.0
        return cls(sign * strength * rng.uniform(0.15, 0.3), rng.uniform(0.35, 0.65))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        after = time >= self.instant * time[-1]
        return force * np.where(after, 1.0 + self.share, 1.0)


@dataclass(frozen=True)
class Bursts:
    """Decaying spikes at random instants, either sign."""

    name: ClassVar[str] = "bursts"
    height_n: float
    rate_hz: float
    decay_s: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Bursts:
        rate, decay = rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.4)
        return cls(strength * rng.uniform(2.0, 4.0), rate, decay)

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        out: Vector = force.copy()
        for start in rng.uniform(0.0, time[-1], max(1, int(rng.poisson(self.rate_hz * time[-1])))):
            late = time - start
            shape = np.where(late >= 0.0, np.exp(-np.maximum(late, 0.0) / self.decay_s), 0.0)
            out = out + self.height_n * float(rng.normal()) * shape
        return out


@dataclass(frozen=True)
class CubicCell:
    """A load cell with a cubic term: F + c F^3."""

    name: ClassVar[str] = "cubic_cell"
    cubic_per_n2: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> CubicCell:
        sign = 1.0 if rng.random() < 0.5 else -1.0
        return cls(sign * strength * rng.uniform(3.0e-4, 6.0e-4))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        extra: Vector = self.cubic_per_n2 * force**3
        return force + extra


FOREIGN = {f.name: f for f in (Hum, Cogging, Backlash, LevelStep, Bursts, CubicCell)}


def draw_foreign(name: str, rng: Rng, strength: float = 1.0) -> Foreign:
    """A foreign effect of random size; RMS about one to three times the noise at strength 1."""
    if name not in FOREIGN:
        raise ValueError(f"no foreign effect named {name!r}; there are {', '.join(FOREIGN)}")
    foreign: Foreign = FOREIGN[name].draw(rng, strength)
    return foreign


def parameters(foreign: Foreign) -> dict[str, float]:
    """The drawn values, for the truth file."""
    return {key: float(value) for key, value in asdict(foreign).items()}  # type: ignore[call-overload]
