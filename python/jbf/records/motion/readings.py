"""Readings of a motion and their errors."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf._core import MotionReadings, SmoothedMotion

Array = npt.NDArray[np.float64]

SPAN = 5
"""Number of samples over which a first estimate of the speed is averaged."""
AT_REST = 1e-3
"""Relative standard error of a velocity that is zero because the shaft is at rest."""


@dataclass(frozen=True)
class ReadingErrors:
    """Errors of the readings of a motion, and the noise that drives it.

    Attributes
    ----------
    position_variance, velocity_variance
        Variances of the readings, m^2 and (m/s)^2 (radians for a rotary motion).
    stamp_variance
        Variance of the time stamps, s^2: adds `v^2 stamp_variance` to the variance of the position.
    intensity
        Intensity of the noise that drives the motion, (m/s^3)^2 s or (m/s^4)^2 s.
    order
        Order of the derivative of the position that is noise: three (jerk) or four (snap).
    velocity_delay_s
        Delay of the velocity relative to the position, s: the value recorded at t is the velocity
        at t minus this delay.
    """

    position_variance: float
    velocity_variance: float
    stamp_variance: float
    intensity: float
    order: int = 3
    velocity_delay_s: float = 0.0


@dataclass(frozen=True)
class Readings:
    """Readings of a motion; all arrays of shape (n,).

    Attributes
    ----------
    time_s
        Instants, s, not decreasing.
    position, velocity
        Readings, m and m/s; nan where missing.
    position_floor, velocity_floor
        Smallest variances of the readings, from the step of an encoder or a digit.
    position_shape, velocity_shape
        Relative standard errors of the samples: factors of those in `ReadingErrors`. A velocity
        assigned at rest has the factor `AT_REST`.
    """

    time_s: Array
    position: Array
    velocity: Array
    position_floor: float
    velocity_floor: float
    position_shape: Array
    velocity_shape: Array

    def part(self, part: slice) -> Readings:
        """Return the readings of a part of the samples."""
        return replace(
            self,
            time_s=self.time_s[part],
            position=self.position[part],
            velocity=self.velocity[part],
            position_shape=self.position_shape[part],
            velocity_shape=self.velocity_shape[part],
        )

    def first_speed(self) -> Array:
        """First estimate of the speed, for the effect of time-stamp errors, shape (n,)."""
        if np.isfinite(self.velocity).all():
            return self.velocity
        time = self.time_s
        step = float(time[-1] - time[0]) / max(len(time) - 1, 1)
        slope = np.nan_to_num(np.gradient(self.position, step))
        return np.convolve(slope, np.ones(SPAN) / SPAN, "same")

    def __getstate__(self) -> dict[str, Any]:
        # The copy for the core cannot be pickled.
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @cached_property
    def _core(self) -> MotionReadings:
        return MotionReadings(
            self.time_s,
            self.position,
            self.position_shape,
            self.position_floor,
            self.velocity,
            self.velocity_shape,
            self.velocity_floor,
            AT_REST,
        )

    def smoothed(self, errors: ReadingErrors, corners: Array, speed: Array) -> SmoothedMotion:
        """Posterior of the motion for given errors.

        Parameters
        ----------
        corners
            Factor of the noise intensity in each step, shape (n - 1,).
        speed
            A velocity at each sample, for the effect of the errors of the time stamps.
        """
        return self._core.smoothed(errors, corners, speed)

    def log_likelihood(self, errors: ReadingErrors, corners: Array, speed: Array) -> float:
        """Log-likelihood of the readings; arguments as in :meth:`smoothed`."""
        return self._core.log_likelihood(errors, corners, speed)

    def lower_bound(self, errors: ReadingErrors, corners: Array) -> float:
        """Variational lower bound of the log-likelihood, marginal over the factors of all steps."""
        return self._core.lower_bound(errors, corners, self.first_speed())

    def estimated(
        self, errors: ReadingErrors, corners: Array, passes: tuple[int, int]
    ) -> tuple[ReadingErrors, Array]:
        """Errors and factors by expectation-maximisation from starting values.

        Parameters
        ----------
        passes
            Largest numbers of passes with normal noise, for a start, and with a t distribution.
        """
        position, velocity, stamp, intensity, factors = self._core.estimated(
            errors, corners, passes, False
        )
        found = replace(
            errors,
            position_variance=position,
            velocity_variance=velocity,
            stamp_variance=stamp,
            intensity=intensity,
        )
        return found, factors

    def corners(self, errors: ReadingErrors, passes: int) -> Array:
        """Estimate the intensity factors in `passes` passes, with known errors."""
        return self._core.estimated(errors, np.ones(len(self.time_s) - 1), (0, passes), True)[-1]
