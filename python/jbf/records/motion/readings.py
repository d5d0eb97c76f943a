"""Position and velocity readings of a motion, and their errors."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf._core import MotionReadings, SmoothedMotion
from jbf.arrays import Array

IndexArray = npt.NDArray[np.intp]

SPAN = 5
"""Number of samples over which a first estimate of the speed is averaged."""
AT_REST = 1e-3
"""Relative standard error of a velocity that is zero because the shaft is at rest."""


@dataclass(frozen=True)
class ReadingErrors:
    """Error variances of motion readings, and the noise process of the motion itself.

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


@dataclass(frozen=True, eq=False)
class ForceReadings:
    """Force readings as linear functions of position, velocity and acceleration.

    Attributes
    ----------
    instants_s
        Instants of the readings, s, shape (n,).
    rows
        Coefficients of position, velocity and acceleration, shape (n, 3).
    values
        Force readings, in the unit of the force, shape (n,).
    variances
        Error variances of the values; infinite for a sample that is not used.
    """

    instants_s: Array
    rows: Array
    values: Array
    variances: Array


@dataclass(frozen=True)
class Readings:
    """Position and velocity readings of a motion; all arrays have shape (n,).

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

    def at(self, instants_s: Array) -> tuple[Readings, IndexArray, IndexArray]:
        """Insert instants without readings.

        Returns
        -------
        readings : Readings
            Readings at the union of the instants.
        samples, added : ndarray of int
            Indices of the original samples and of the added instants in it.
        """
        union, index = np.unique(np.concatenate([self.time_s, instants_s]), return_inverse=True)
        samples, added = index[: len(self.time_s)], index[len(self.time_s) :]

        def spread(values: Array, missing: float) -> Array:
            """Values at the original samples, and `missing` at the added instants."""
            spread_values = np.full(len(union), missing)
            spread_values[samples] = values
            return spread_values

        readings = replace(
            self,
            time_s=union,
            position=spread(self.position, np.nan),
            velocity=spread(self.velocity, np.nan),
            position_shape=spread(self.position_shape, 1.0),
            velocity_shape=spread(self.velocity_shape, 1.0),
        )
        return readings, samples, added

    def positions(self) -> Readings:
        """Readings without the measured velocities; the velocities assigned at rest are kept."""
        assigned = self.velocity_shape <= AT_REST
        return replace(self, velocity=np.where(assigned, self.velocity, np.nan))

    def part(self, part: slice) -> Readings:
        """Readings of a slice of the samples."""
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
        span = min(SPAN, len(time))
        return np.convolve(slope, np.ones(span) / span, "same")

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
        """Posterior of the motion for given reading errors.

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
        self,
        errors: ReadingErrors,
        corners: Array,
        passes: tuple[int, int],
        *,
        known_intensity: bool = False,
    ) -> tuple[ReadingErrors, Array]:
        """Estimate reading errors and step factors by expectation-maximisation.

        Parameters
        ----------
        passes
            Largest numbers of passes with normal noise, for a start, and with a t distribution.
        known_intensity
            Whether the intensity keeps its starting value.
        """
        position, velocity, stamp, intensity, factors = self._core.estimated(
            errors, corners, passes, "intensity" if known_intensity else "nothing"
        )
        found = replace(
            errors,
            position_variance=position,
            velocity_variance=velocity,
            stamp_variance=stamp,
            intensity=intensity,
        )
        return found, factors

    def corners(
        self, errors: ReadingErrors, passes: int, forces: ForceReadings | None = None
    ) -> Array:
        """Estimate the factor of the noise intensity in each step, with known errors.

        Parameters
        ----------
        passes
            Number of passes of expectation-maximisation.
        forces
            Forces that are used as further readings of the motion.

        Returns
        -------
        Array
            Factors, shape (n - 1,).
        """
        ones = np.ones(len(self.time_s) - 1)
        if forces is None:
            return self._core.estimated(errors, ones, (0, passes), "everything")[-1]
        joint, _, at_forces = self.at(forces.instants_s)
        count = len(joint.time_s)
        rows, values, variances = np.zeros((count, 3)), np.zeros(count), np.full(count, np.inf)
        rows[at_forces], values[at_forces] = forces.rows, forces.values
        variances[at_forces] = forces.variances
        # The instants of the forces divide steps between readings, which keep one factor each.
        step = np.searchsorted(self.time_s, joint.time_s[:-1], "right") - 1
        step = np.clip(step, 0, len(ones) - 1)
        linear = (rows, values, variances, np.diff(step, prepend=-1) == 0)
        factors = joint._core.estimated(errors, ones[step], (0, passes), "everything", linear)[-1]
        return factors[np.searchsorted(step, np.arange(len(ones)))]
