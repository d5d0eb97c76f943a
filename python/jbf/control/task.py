"""Task of a loop: its reference, and the interval over which its error is evaluated."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from jbf.errors import InputError, did_you_mean

WAVES = ("sine", "triangle", "square")
RECORDED = "recorded"
"""Value of `Task.wave` if the reference is given sample by sample."""

_FARTHEST = 1e6


@dataclass(frozen=True)
class Task:
    """Periodic reference for position or velocity control.

    Attributes
    ----------
    control
        Controlled quantity.
    wave
        Form of the reference, such as `sine`, `triangle` or `square`.
    low, high
        Limits of the reference, rad or rad/s.
    frequency_rad_s
        Angular frequency of the reference.
    seconds
        Duration of the run, s.
    skip_s
        Start of the interval over which the error is evaluated, s.
    """

    control: Literal["position", "velocity"]
    wave: str
    low: float
    high: float
    frequency_rad_s: float
    seconds: float = 50.0
    skip_s: float = 0.0

    def __post_init__(self) -> None:
        if self.control not in ("position", "velocity"):
            raise InputError(
                problem=f'control "{self.control}" is not known',
                remedy="write position or velocity",
            )
        if self.wave not in (*WAVES, RECORDED):
            raise InputError(
                problem=f'wave "{self.wave}" is not known', remedy=did_you_mean(self.wave, WAVES)
            )
        if not -_FARTHEST <= self.low < self.high <= _FARTHEST:
            raise InputError(
                problem=f"low {self.low} and high {self.high} are not a valid range",
                remedy="give low < high, both within one million",
            )
        if not 0.0 < self.frequency_rad_s < math.inf:
            raise InputError(
                problem=f"frequency {self.frequency_rad_s} rad/s is not positive",
                remedy="correct the value",
            )
        if not 0.0 <= self.skip_s < self.seconds <= 1e5:
            raise InputError(
                problem=f"{self.seconds} s with {self.skip_s} s omitted is not a valid duration",
                remedy="give up to 100,000 s, and omit less than the whole",
            )

    @property
    def is_position(self) -> bool:
        """Whether the position is controlled."""
        return self.control == "position"

    @property
    def period_s(self) -> float:
        """Period of the reference, s."""
        return 2.0 * math.pi / self.frequency_rad_s

    @property
    def unit(self) -> str:
        """Unit of reference and error: rad or rad/s."""
        return "rad" if self.is_position else "rad/s"

    @property
    def top_speed_rad_s(self) -> float:
        """Largest speed of the reference, rad/s; zero for a square wave in position control."""
        if not self.is_position:
            return max(abs(self.low), abs(self.high))
        span = self.high - self.low
        if self.wave == "square":
            return 0.0
        return span * (0.5 if self.wave == "sine" else 1.0 / math.pi) * self.frequency_rad_s


# In velocity control the initial error is up to 2 rad/s, but no printed peak contains this error:
# the thesis must have excluded the start. In position control the printed peaks occur at the start.
_EXCLUDED_START_S = 2.0


def _position(wave: str, low: float, high: float, frequency: float) -> Task:
    return Task("position", wave, low, high, frequency)


def _velocity(wave: str, low: float, high: float, frequency: float) -> Task:
    return Task("velocity", wave, low, high, frequency, 50.0 + _EXCLUDED_START_S, _EXCLUDED_START_S)


TASKS = {
    "position triangle": _position("triangle", 0.0, 10.4, 0.628),
    "position square": _position("square", -1.04, 1.04, 0.25),
    "position sine": _position("sine", -1.04, 1.04, 0.25),
    "velocity sine": _velocity("sine", -1.04, 1.04, 0.25),
    "velocity triangle": _velocity("triangle", -2.08, 2.08, 0.5),
    "velocity square": _velocity("square", -1.04, 1.04, 0.25),
    "velocity sine 20.8": _velocity("sine", 0.52, 20.8, 0.25),
}
"""Seven tasks by name, the rows of Tables 6.1 and 6.2 of Cohn (1998)."""
