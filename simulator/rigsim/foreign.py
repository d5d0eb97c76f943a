"""Effects that are in no catalogue, to test whether a diagnosis reports "unexplained".

The parameters of an effect are drawn once per campaign. `apply` takes time (s), angle (rad), speed
(m/s) and force (N) of a record without noise, and returns the changed force.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import ClassVar, Protocol

import numpy as np

from .record import Vector

Rng = np.random.Generator


class Foreign(Protocol):
    """Interface of an effect that is in no catalogue."""

    name: ClassVar[str]

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        """Return the force (N) with the effect; `rng` is the random number generator of the run."""


@dataclass(frozen=True)
class Hum:
    """Force with one frequency and a different phase in each run."""

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
    """Cross-talk of the motor: a force at a high harmonic of the angle."""

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
class LevelStep:
    """Relative change of the friction at one instant of every run."""

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
    """Decaying spikes of the force at random instants, with either sign."""

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
class Chatter:
    """Squeal of a slide: a force with one frequency below a speed limit.

    The phase differs between runs.
    """

    name: ClassVar[str] = "chatter"
    amplitude_n: float
    frequency_hz: float
    below_m_s: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Chatter:
        frequency, below = rng.uniform(3.0, 9.0), rng.uniform(0.01, 0.03)
        return cls(strength * rng.uniform(2.0, 4.0), frequency, below)

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        phase = rng.uniform(0.0, 2.0 * math.pi)
        tone = self.amplitude_n * np.sin(2.0 * math.pi * self.frequency_hz * time + phase)
        slow = (np.abs(speed) < self.below_m_s) & (speed != 0.0)
        return force + np.where(slow, tone, 0.0)


@dataclass(frozen=True)
class Scratch:
    """Groove or burr: additional friction at one or two narrow ranges of the angle."""

    name: ClassVar[str] = "scratch"
    height_n: float
    place_rad: float
    second: float  # height at the second position relative to the first; 0 without a second one
    second_rad: float
    kappa: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> Scratch:
        height, first = strength * rng.uniform(2.0, 4.0), rng.uniform(0.0, 2.0 * math.pi)
        second = rng.uniform(0.5, 1.0) if rng.random() < 0.5 else 0.0
        beyond = first + rng.uniform(1.0, 5.0)
        return cls(height, first, second, beyond, rng.uniform(60.0, 200.0))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        bumps = np.exp(self.kappa * (np.cos(angle - self.place_rad) - 1.0))
        bumps += self.second * np.exp(self.kappa * (np.cos(angle - self.second_rad) - 1.0))
        out: Vector = force + self.height_n * bumps * np.sign(speed)
        return out


@dataclass(frozen=True)
class StrokeScatter:
    """Friction level that varies at random from stroke to stroke."""

    name: ClassVar[str] = "stroke_scatter"
    share: float

    @classmethod
    def draw(cls, rng: Rng, strength: float) -> StrokeScatter:
        return cls(strength * rng.uniform(0.06, 0.12))

    def apply(self, time: Vector, angle: Vector, speed: Vector, force: Vector, rng: Rng) -> Vector:
        # Small oscillations about a rest do not count as reversals.
        moving = np.flatnonzero(np.abs(speed) > 0.02 * np.max(np.abs(speed)))
        directions = np.sign(speed[moving])
        turned = moving[1:][directions[1:] != directions[:-1]]
        stroke = np.searchsorted(turned, np.arange(len(speed)), side="right")
        levels = 1.0 + self.share * rng.standard_normal(len(turned) + 1)
        return force * levels[stroke]


FOREIGN = {f.name: f for f in (Hum, Cogging, LevelStep, Bursts, Chatter, Scratch, StrokeScatter)}


def draw_foreign(name: str, rng: Rng, strength: float = 1.0) -> Foreign:
    """Draw a foreign effect of random size: RMS one to three times the noise at strength 1."""
    if name not in FOREIGN:
        raise ValueError(f"no foreign effect named {name!r}; there are {', '.join(FOREIGN)}")
    foreign: Foreign = FOREIGN[name].draw(rng, strength)
    return foreign


def parameters(foreign: Foreign) -> dict[str, float]:
    """Return the drawn parameters of a foreign effect for the file of the true values."""
    return {key: float(value) for key, value in asdict(foreign).items()}  # type: ignore[call-overload]
