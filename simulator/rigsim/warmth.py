"""Temperature of the machine: a room, a drive that warms up, several days."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Vector = npt.NDArray[np.float64]
Kind = Literal["wandering", "warming", "days"]

REFERENCE_C = 25.0
"""Temperature for which the parameters of a rig are given, C."""
OIL_K = 95.0
"""Distance below 0 C of the temperature at which the viscosity of a mineral oil diverges, K."""


@dataclass(frozen=True)
class Warmth:
    """Temperature of one run as a function of time: start, oscillation and exponential rise, C."""

    start_c: float
    swing_k: float = 0.0
    period_s: float = 60.0
    phase: float = 0.0
    rise_k: float = 0.0
    tau_s: float = 20.0

    def at(self, time_s: float) -> float:
        """Return the temperature at a time, C."""
        swing = self.swing_k * math.sin(2.0 * math.pi * time_s / self.period_s + self.phase)
        return self.start_c + swing - self.rise_k * math.expm1(-time_s / self.tau_s)

    def along(self, times: Vector) -> Vector:
        """Return the temperatures at several times (s), C."""
        return np.array([self.at(t) for t in times.tolist()])


def draw_warmth(kind: Kind, number: int, duration_s: float, rng: np.random.Generator) -> Warmth:
    """Draw the temperature of run `number` of a campaign."""
    if kind == "warming":  # the same in every run: each starts cold
        return Warmth(18.0, rise_k=16.0, tau_s=12.0)
    if kind == "days":
        return Warmth(float(18.0 + 6.0 * (number % 5) + rng.uniform(-1.0, 1.0)))
    return Warmth(
        start_c=float(rng.uniform(19.0, 33.0)),
        swing_k=float(rng.uniform(3.0, 6.0)),
        period_s=duration_s * float(rng.uniform(0.6, 1.5)),
        phase=float(rng.uniform(0.0, 2.0 * math.pi)),
    )


def thinner(b_k: float, temperature_c: float) -> float:
    """Viscosity relative to that at the reference temperature, by the equation of Vogel."""
    actual, reference = temperature_c + OIL_K, REFERENCE_C + OIL_K
    return float(10.0 ** (b_k / math.log(10.0) * (reference - actual) / (actual * reference)))


def read_by(thermometer: str, times: Vector, celsius: Vector, rng: np.random.Generator) -> Vector:
    """Return thermometer readings: `fine` (0.05 K noise) or `coarse` (whole degrees, 1 Hz)."""
    if thermometer == "coarse":
        tick = np.searchsorted(times, np.floor(times - times[0]) + times[0] - 1e-9)
        return np.round(celsius[tick])
    return celsius + 0.05 * rng.standard_normal(len(times))
