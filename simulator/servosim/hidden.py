"""Effects hidden in a simulated drive: friction and forces that its basic model lacks.

Sizes are drawn relative to the friction, speed and stroke of the drive. The names in `EFFECTS` are
those of the library's catalogue; no catalogue contains those in `UNKNOWN`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Protocol

import numpy as np

Rng = np.random.Generator


@dataclass
class Course:
    """Present state of a run, on which hidden effects depend.

    Attributes
    ----------
    time
        Since the start of the run, s.
    position, velocity
        rad and rad/s, or m and m/s.
    strokes
        Number of reversals so far.
    phase
        Phase of a disturbance in this run, rad.
    scatter
        Standard normal numbers of the run, one per stroke.
    """

    time: float
    position: float
    velocity: float
    strokes: int
    phase: float
    scatter: list[float]


@dataclass(frozen=True)
class Scale:
    """Quantities of the drive by which the effects are scaled.

    They are Coulomb friction, viscous friction, largest speed and a typical stroke.
    """

    coulomb: float
    viscous: float
    top: float
    stroke: float


class Hidden(Protocol):
    """Interface of a hidden effect, evaluated in the middle of each piece of the motion."""

    name: ClassVar[str]

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> Hidden:
        """Draw an effect of typical size for a drive."""

    def level(self, at: Course) -> float:
        """Additional Coulomb friction, N m or N."""

    def drag(self, at: Course) -> float:
        """Additional viscous friction, with the sign of the velocity if it opposes it, N m or N."""

    def viscous_factor(self, at: Course) -> float:
        """Factor on all viscous friction at a state of the motion."""

    def factor(self, at: Course) -> float:
        """Factor on the total friction at a state of the motion."""

    def push(self, at: Course) -> float:
        """Force that the drive must overcome, independent of the direction of motion."""

    def lost_share(self) -> float:
        """Fraction of the transmitted force that is lost as friction."""


@dataclass(frozen=True)
class Plain:
    """Base class of an effect without influence; subclasses override what they change."""

    def level(self, at: Course) -> float:
        return 0.0

    def drag(self, at: Course) -> float:
        return 0.0

    def viscous_factor(self, at: Course) -> float:
        return 1.0

    def factor(self, at: Course) -> float:
        return 1.0

    def push(self, at: Course) -> float:
        return 0.0

    def lost_share(self) -> float:
        return 0.0


@dataclass(frozen=True)
class StribeckExcess(Plain):
    """Stribeck effect: higher friction at low speed."""

    name: ClassVar[str] = "stribeck_excess"
    height: float
    speed: float
    exponent: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> StribeckExcess:
        height = scale.coulomb * random.uniform(0.3, 0.9)
        return cls(height, scale.top * random.uniform(0.03, 0.1), random.uniform(1.0, 2.0))

    def level(self, at: Course) -> float:
        return self.height * math.exp(-((abs(at.velocity) / self.speed) ** self.exponent))


@dataclass(frozen=True)
class ViscousAsymmetry(Plain):
    """Viscous friction with different slopes in the two directions."""

    name: ClassVar[str] = "viscous_asymmetry"
    slope: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> ViscousAsymmetry:
        share = random.uniform(0.2, 0.4) * random.choice([-1.0, 1.0])
        return cls(share * (scale.viscous + 0.2 * scale.coulomb / scale.top))

    def drag(self, at: Course) -> float:
        return self.slope * abs(at.velocity)


@dataclass(frozen=True)
class ViscousThinning(Plain):
    """Viscous friction that grows less than proportionally to the speed."""

    name: ClassVar[str] = "viscous_thinning"
    slowness: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> ViscousThinning:
        return cls(random.uniform(1.0, 3.0) / scale.top)

    def viscous_factor(self, at: Course) -> float:
        return 1.0 / (1.0 + self.slowness * abs(at.velocity))


@dataclass(frozen=True)
class TorqueProportional(Plain):
    """Friction proportional to the transmitted force."""

    name: ClassVar[str] = "torque_proportional"
    share: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> TorqueProportional:
        return cls(random.uniform(0.08, 0.2))

    def lost_share(self) -> float:
        return self.share


@dataclass(frozen=True)
class Cogging(Plain):
    """Force that is periodic in the position."""

    name: ClassVar[str] = "cogging"
    amplitude: float
    pitch: float
    phase: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> Cogging:
        amplitude = scale.coulomb * random.uniform(0.1, 0.3)
        pitch = scale.stroke / random.uniform(2.0, 8.0)
        return cls(amplitude, pitch, random.uniform(0.0, 2.0 * math.pi))

    def push(self, at: Course) -> float:
        return self.amplitude * math.sin(2.0 * math.pi * at.position / self.pitch - self.phase)


@dataclass(frozen=True)
class PitchRipple(Plain):
    """Friction that is periodic in the position."""

    name: ClassVar[str] = "pitch_ripple"
    depth: float
    pitch: float
    phase: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> PitchRipple:
        pitch = scale.stroke / random.uniform(2.0, 8.0)
        return cls(random.uniform(0.1, 0.25), pitch, random.uniform(0.0, 2.0 * math.pi))

    def factor(self, at: Course) -> float:
        return 1.0 + self.depth * math.cos(2.0 * math.pi * at.position / self.pitch - self.phase)


@dataclass(frozen=True)
class WarmUp(Plain):
    """Friction that decreases from the start of each run."""

    name: ClassVar[str] = "warm_up"
    excess: float
    time_constant_s: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> WarmUp:
        return cls(random.uniform(0.15, 0.4), random.uniform(1.5, 5.0))

    def factor(self, at: Course) -> float:
        return 1.0 + self.excess * math.exp(-at.time / self.time_constant_s)


@dataclass(frozen=True)
class Hum(Plain):
    """Force with one frequency and a different phase in each run."""

    name: ClassVar[str] = "hum"
    amplitude: float
    frequency_hz: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> Hum:
        return cls(scale.coulomb * random.uniform(0.1, 0.3), random.uniform(1.0, 6.0))

    def push(self, at: Course) -> float:
        return self.amplitude * math.sin(2.0 * math.pi * self.frequency_hz * at.time + at.phase)


@dataclass(frozen=True)
class LevelStep(Plain):
    """Coulomb friction that changes at one instant of every run."""

    name: ClassVar[str] = "level_step"
    change: float
    instant_s: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> LevelStep:
        share = random.uniform(0.15, 0.35) * random.choice([-1.0, 1.0])
        return cls(scale.coulomb * share, random.uniform(2.5, 4.0))

    def level(self, at: Course) -> float:
        return self.change if at.time > self.instant_s else 0.0


@dataclass(frozen=True)
class StrokeScatter(Plain):
    """Coulomb friction that varies at random from stroke to stroke."""

    name: ClassVar[str] = "stroke_scatter"
    sd: float

    @classmethod
    def draw(cls, scale: Scale, random: Rng) -> StrokeScatter:
        return cls(scale.coulomb * random.uniform(0.1, 0.2))

    def level(self, at: Course) -> float:
        return self.sd * max(-2.5, min(2.5, at.scatter[at.strokes % len(at.scatter)]))


EFFECTS: dict[str, type[Hidden]] = {
    kind.name: kind
    for kind in (
        StribeckExcess,
        ViscousAsymmetry,
        ViscousThinning,
        TorqueProportional,
        Cogging,
        PitchRipple,
        WarmUp,
    )
}
UNKNOWN: dict[str, type[Hidden]] = {kind.name: kind for kind in (Hum, LevelStep, StrokeScatter)}


@dataclass(frozen=True)
class Together:
    """All hidden effects of one drive; terms are added, factors multiplied."""

    parts: tuple[Hidden, ...] = field(default=())

    @cached_property
    def _acting(self) -> dict[str, tuple[Hidden, ...]]:
        """For each method of `Plain`, the effects that override it."""
        names = ("level", "drag", "viscous_factor", "factor", "push", "lost_share")
        return {
            name: tuple(p for p in self.parts if getattr(type(p), name) is not getattr(Plain, name))
            for name in names
        }

    def level(self, at: Course) -> float:
        return sum([part.level(at) for part in self._acting["level"]])

    def drag(self, at: Course) -> float:
        return sum([part.drag(at) for part in self._acting["drag"]])

    def viscous_factor(self, at: Course) -> float:
        return math.prod([part.viscous_factor(at) for part in self._acting["viscous_factor"]])

    def factor(self, at: Course) -> float:
        return math.prod([part.factor(at) for part in self._acting["factor"]])

    def push(self, at: Course) -> float:
        return sum([part.push(at) for part in self._acting["push"]])

    def lost_share(self) -> float:
        return sum([part.lost_share() for part in self._acting["lost_share"]])


NOTHING = Together()
"""No hidden effect."""
