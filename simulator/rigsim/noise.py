"""Measurement noise of the rig's load cell, tachometer and encoder."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .record import Vector


@dataclass(frozen=True)
class Noise:
    """Noise levels of the sensors of a rig.

    Attributes
    ----------
    friction_n
        Standard deviation of the white part of the friction noise, N.
    coloured_share
        Standard deviation of the first-order coloured part, relative to the white part.
    correlation_s
        Time constant of the coloured part, s.
    velocity_m_s
        Standard deviation of the speed, m/s; the noise is zero where the speed is exactly zero.
    counts_per_rad
        Encoder counts per radian.
    """

    friction_n: float
    coloured_share: float = 0.0
    correlation_s: float = 0.2
    velocity_m_s: float = 1e-4
    counts_per_rad: float = 2387.3

    def friction(self, clean: Vector, step_s: float, rng: np.random.Generator) -> Vector:
        """Return `clean` (N), sampled every `step_s`, with white and coloured noise."""
        noisy = clean + self.friction_n * rng.standard_normal(len(clean))
        if self.coloured_share > 0.0:
            keep = math.exp(-step_s / self.correlation_s)
            kick = math.sqrt(1.0 - keep * keep) * rng.standard_normal(len(clean))
            state = float(rng.standard_normal())
            tail = np.empty(len(clean))
            for i, k in enumerate(kick.tolist()):
                tail[i] = state
                state = keep * state + k
            noisy += self.coloured_share * self.friction_n * tail
        return noisy

    def velocity(self, true: Vector, rng: np.random.Generator) -> Vector:
        """Return the speed (m/s) with noise."""
        return np.where(true == 0.0, 0.0, true + self.velocity_m_s * rng.standard_normal(len(true)))

    def angle(self, true: Vector) -> Vector:
        """Return the angle (rad) rounded to whole encoder counts."""
        return np.round(true * self.counts_per_rad) / self.counts_per_rad
