"""Readings of a motion and their errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf._core import MotionReadings, SmoothedMotion

Array = npt.NDArray[np.float64]

SPAN = 5
"""Samples over which a first guess of the speed is averaged."""
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
        Variance of the time stamps, s^2: adds `v^2 stamp_variance` to the position's variance.
    intensity
        Intensity of the noise that drives the motion, (m/s^3)^2 s or (m/s^4)^2 s.
    order
        Which derivative of the position is noise: the third, the jerk, or the fourth, the snap.
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
    """The readings of a motion; all arrays of shape (n,).

    Attributes
    ----------
    time_s
        Instants, s, not decreasing.
    position, velocity
        Readings, m and m/s. NaN where there is none.
    position_floor, velocity_floor
        Smallest variances that the readings can have, of an encoder's or a digit's step.
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
        """The readings of some of the samples."""
        return replace(
            self,
            time_s=self.time_s[part],
            position=self.position[part],
            velocity=self.velocity[part],
            position_shape=self.position_shape[part],
            velocity_shape=self.velocity_shape[part],
        )

    def first_speed(self) -> Array:
        """A first guess of the speed, for the effect of the stamps' errors, shape (n,)."""
        if np.isfinite(self.velocity).all():
            return self.velocity
        time = self.time_s
        step = float(time[-1] - time[0]) / max(len(time) - 1, 1)
        slope = np.nan_to_num(np.gradient(self.position, step))
        return np.convolve(slope, np.ones(SPAN) / SPAN, "same")

    def smoothed(self, errors: ReadingErrors, corners: Array, speed: Array) -> SmoothedMotion:
        """Posterior of the motion for given errors.

        Parameters
        ----------
        corners
            Factor of the noise's intensity in each step, shape (n - 1,).
        speed
            A velocity at each sample, for the effect of the stamps' errors.
        """
        return self._with(errors, corners, speed).smoothed()

    def log_likelihood(self, errors: ReadingErrors, corners: Array, speed: Array) -> float:
        """Log likelihood of the readings; arguments as of :meth:`smoothed`."""
        return self._with(errors, corners, speed).log_likelihood()

    def _with(self, errors: ReadingErrors, corners: Array, speed: Array) -> MotionReadings:
        position, velocity = self.variances(errors, speed)
        return MotionReadings(
            self.time_s,
            self.position,
            position,
            self.velocity,
            velocity,
            errors.intensity * corners,
            errors.order,
            errors.velocity_delay_s,
        )

    def variances(self, errors: ReadingErrors, speed: Array) -> tuple[Array, Array]:
        """Variances of position and velocity at each sample; infinite where there is no reading."""
        position = (
            errors.position_variance * self.position_shape**2 + errors.stamp_variance * speed**2
        )
        velocity = errors.velocity_variance * self.velocity_shape**2
        return (
            np.where(np.isfinite(self.position), position, np.inf),
            np.where(np.isfinite(self.velocity), velocity, np.inf),
        )
