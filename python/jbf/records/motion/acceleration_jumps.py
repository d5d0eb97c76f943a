"""Jumps of the acceleration of a motion, of known sizes at known instants."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from jbf.arrays import Array
from jbf.records.motion.reading_errors import JERK
from jbf.records.motion.readings import ForceReadings, ReadingErrors, Readings

JUMP_SIGMA = 2.0
"""Number of standard errors within which the instant of a jump is uncertain."""


@dataclass(frozen=True, eq=False)
class Jumps:
    """Jumps of the acceleration of a motion, of known sizes at known instants.

    The posterior of a motion with such jumps is that of the remaining motion plus the motion that
    the jumps cause.

    Attributes
    ----------
    instants_s
        Instants, s, increasing, shape (m,).
    sizes
        Changes of the acceleration, m/s^2 (rad/s^2 for a rotary motion), shape (m,).
    instant_errors_s
        Standard errors of the instants, s, shape (m,).
    """

    instants_s: Array
    sizes: Array
    instant_errors_s: Array

    def at(self, time_s: Array) -> Array:
        """Motion that the jumps alone cause from rest: position and derivatives, shape (n, 3)."""
        start = np.searchsorted(self.instants_s, time_s, "right")
        # Position, velocity and acceleration after each jump, after rest before the first one.
        step_s = np.diff(self.instants_s, prepend=self.instants_s[:1])
        after = np.cumsum(self.sizes)
        before = after - self.sizes
        v = np.cumsum(before * step_s)
        x = np.cumsum((v - before * step_s) * step_s + 0.5 * before * step_s**2)
        since_s = time_s - np.concatenate((time_s[:1], self.instants_s))[start]
        x, v, a = (np.concatenate(([0.0], state))[start] for state in (x, v, after))
        return np.column_stack((x + v * since_s + 0.5 * a * since_s**2, v + a * since_s, a))

    def subtracted_from(self, readings: Readings, errors: ReadingErrors) -> Readings:
        """Readings of the remaining motion."""
        if not len(self.instants_s):
            return readings
        read_s = readings.time_s - errors.velocity_delay_s
        position = readings.position - self.at(readings.time_s)[:, 0]
        velocity = readings.velocity - self.at(read_s)[:, 1]
        return replace(readings, position=position, velocity=velocity)

    def subtracted_from_forces(self, forces: ForceReadings) -> ForceReadings:
        """Forces without the part due to the jumps."""
        part = np.sum(forces.rows * self.at(forces.instants_s), axis=1)
        return replace(forces, values=forces.values - part)

    def corners(self, time_s: Array, errors: ReadingErrors) -> Array:
        """Factors of the noise intensity in each step, shape (n - 1,), for uncertain instants.

        If a sample is within two standard errors of a jump, the acceleration may jump by its size
        before or after this sample.
        """
        factors = np.zeros(len(time_s) - 1)
        error_s = JUMP_SIGMA * self.instant_errors_s
        first, last = (
            np.clip(
                np.searchsorted(time_s, self.instants_s + side * error_s, "right") - 1,
                0,
                len(factors) - 1,
            )
            for side in (-1.0, 1.0)
        )
        for i, j, size in zip(first, last, self.sizes, strict=True):
            if j > i:
                steps = slice(i, j + 1)
                step_s = np.maximum(np.diff(time_s[i : j + 2]), 1e-300)
                # Variance of the acceleration after a step with process noise of unit factor.
                power = 2 * (errors.order - JERK) + 1
                variance = errors.intensity * step_s**power / power
                factors[steps] = np.maximum(factors[steps], size**2 / variance)
        return factors

    def added_to(self, mean: Array, time_s: Array) -> Array:
        """States of the motion, shape (n, N), from those of the remaining motion."""
        total: Array = mean.copy()
        total[:, :3] += self.at(time_s)
        return total


NO_JUMPS = Jumps(np.zeros(0), np.zeros(0), np.zeros(0))
