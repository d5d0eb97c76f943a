"""Fixed-interval smoothing of position and velocity with estimated reading errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.records.motion.acceleration_jumps import NO_JUMPS, Jumps
from jbf.records.motion.reading_errors import JERK, LONG_PASSES, estimate_errors, starting_errors
from jbf.records.motion.readings import AT_REST, ForceReadings, ReadingErrors, Readings

SHORTEST = 4
"""Number of samples below which the motion is a parabola through them."""
TURN_GAIN = 3.0
"""Minimum log-likelihood gain of corners at all reversals."""


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Posterior (smoothed estimate) of a motion at n instants.

    Attributes
    ----------
    readings, errors
        Readings, and their estimated errors.
    corners
        Factor on the intensity of the process noise in each step, shape (n - 1,). It is large at
        corners, where the motion changes abruptly.
    own_corners
        Factors as in `corners`, but estimated without the forces, from the readings of the motion.
    jumps
        Known jumps of the acceleration, included in `mean`.
    speed
        Speed at each sample, for the effect of the errors of the time stamps, shape (n,).
    mean, covariance
        Position and its first N - 1 derivatives, shape (n, N), and their covariance, shape (n, N,
        N), where the N-th derivative is noise.
    gain
        Gains of the posterior as a Markov chain backward in time, shape (n - 1, N, N).
    """

    readings: Readings
    errors: ReadingErrors
    corners: Array
    speed: Array
    mean: Array
    covariance: Array
    gain: Array
    own_corners: Array
    jumps: Jumps = NO_JUMPS

    @classmethod
    def of(
        cls,
        readings: Readings,
        errors: ReadingErrors,
        corners: Array,
        speed: Array,
        own_corners: Array | None = None,
        jumps: Jumps = NO_JUMPS,
    ) -> Smoothed:
        """Compute the posterior of a motion for given reading errors."""
        posterior = jumps.subtracted_from(readings, errors).smoothed(errors, corners, speed)
        mean = jumps.added_to(posterior.mean, readings.time_s)
        of_motion = corners if own_corners is None else own_corners
        states = mean, posterior.covariance, posterior.gain
        return cls(readings, errors, corners, speed, *states, of_motion, jumps)

    def with_scaled_intensity(self, factor: float, *, same_corners: bool = False) -> Smoothed:
        """Posterior of the same readings for the noise intensity times a factor.

        Parameters
        ----------
        same_corners
            True to keep the corners and the jumps. Otherwise the corners are estimated again,
            without jumps.
        """
        if self.errors.intensity <= 0.0:
            return self
        errors = replace(self.errors, intensity=factor * self.errors.intensity)
        if same_corners:
            kept = self.corners, self.speed, self.own_corners, self.jumps
            return Smoothed.of(self.readings, errors, *kept)
        return _smoothed(self.readings, errors, self.readings.corners(errors, LONG_PASSES))

    def with_corners_located_by(
        self, forces: ForceReadings | None, jumps: Jumps = NO_JUMPS
    ) -> Smoothed:
        """Posterior of the same readings with corners where the forces require them.

        The forces determine the accelerations more exactly than the readings of the motion do. The
        factor of the noise intensity in each step is the maximum of the factors with and without
        the forces, and of those of jumps at uncertain instants. The forces are not readings of the
        posterior itself. Without jumps, its errors therefore remain independent of theirs.

        Parameters
        ----------
        forces
            Forces as linear functions of the motion; None for the corners without them.
        jumps
            Jumps of the acceleration, which are subtracted before smoothing. Corners are added only
            where their instants are uncertain.
        """
        if self.errors.intensity <= 0.0:
            return self
        corners = self.own_corners
        readings = jumps.subtracted_from(self.readings, self.errors)
        if len(jumps.instants_s):
            corners = _located_to_a_step(readings.corners(self.errors, LONG_PASSES))
        if forces is not None:
            by_forces = readings.corners(
                self.errors, LONG_PASSES, jumps.subtracted_from_forces(forces)
            )
            corners = np.maximum(corners, _located_to_a_step(by_forces))
        corners = np.maximum(corners, jumps.corners(self.readings.time_s, self.errors))
        of_motion = self.own_corners
        return Smoothed.of(self.readings, self.errors, corners, self.speed, of_motion, jumps)

    def at(self, instants_s: Array) -> tuple[Array, Array, Array]:
        """Mean, covariance and gain at other instants, s, not decreasing and within the motion."""
        time = self.readings.time_s
        readings, samples, added = self.readings.at(instants_s)
        speed = np.zeros(len(readings.time_s))
        speed[samples] = self.speed
        last = np.searchsorted(time, readings.time_s[:-1], "right") - 1
        step = np.clip(last, 0, len(time) - 2)
        relative = self.jumps.subtracted_from(readings, self.errors)
        posterior = relative.smoothed(self.errors, self.corners[step], speed)
        mean = self.jumps.added_to(posterior.mean, readings.time_s)
        return mean[added], posterior.covariance[added], _composed(posterior.gain, added)


def _composed(gain: Array, chosen: npt.NDArray[np.intp]) -> Array:
    """Smoother gains between successive chosen instants, as products of the gains of all steps."""
    first, last = chosen[:-1], chosen[1:]
    one = np.eye(gain.shape[1])
    found: Array = np.broadcast_to(one, (len(first), *one.shape)).copy()
    for further in range(int(np.max(last - first, initial=0))):
        reached = first + further < last
        found[reached] = found[reached] @ gain[(first + further)[reached]]
    return found


def smooth(readings: Readings, starts: Sequence[ReadingErrors] = ()) -> Smoothed:
    """Estimate the errors of the readings by maximum likelihood, and smooth the motion.

    Parameters
    ----------
    starts
        Additional starting values for the errors.
    """
    n = len(readings.time_s)
    if n < SHORTEST:
        errors = replace(starting_errors(readings), intensity=0.0)
        return Smoothed.of(readings, errors, np.ones(max(n - 1, 0)), np.zeros(n))
    return _smoothed(readings, *estimate_errors(readings, starts))


def _smoothed(readings: Readings, errors: ReadingErrors, corners: Array) -> Smoothed:
    """Posterior with corners extended to adjacent steps, or with corners at all reversals.

    Corners at all reversals are used if they are more likely.
    """
    mean = readings.smoothed(errors, corners, np.zeros(len(readings.time_s))).mean
    found = _located_to_a_step(corners)
    if errors.order == JERK:
        turns = _of_reversals(readings, errors, mean)
        tried = _located_to_a_step(np.maximum(corners, turns))
        without, with_turns = (
            readings.log_likelihood(errors, c, mean[:, 1]) for c in (found, tried)
        )
        if with_turns > without + TURN_GAIN:
            found = tried
    return Smoothed.of(readings, errors, found, mean[:, 1])


def _of_reversals(readings: Readings, errors: ReadingErrors, mean: Array) -> Array:
    """Noise-intensity factors that permit a jump of the acceleration at each reversal.

    In a step with a reversal the friction reverses too, so that the acceleration may change by its
    RMS. The factors are zero in the other steps.
    """
    step_s = np.maximum(np.diff(readings.time_s), 1e-300)
    at_rest = readings.velocity_shape <= AT_REST
    reverses = (mean[1:, 1] * mean[:-1, 1] <= 0.0) & ~(at_rest[1:] & at_rest[:-1])
    square = float(np.mean(mean[:, 2] ** 2))
    return np.where(reverses, square / (max(errors.intensity, 1e-300) * step_s), 0.0)


def _located_to_a_step(corners: Array) -> Array:
    """Noise-intensity factors with each corner extended to the adjacent steps.

    The expectation for one step neglects that a corner in an adjacent step has nearly the same
    likelihood. Without the extension, the standard error of the acceleration at the sample between
    the two steps is too small.
    """
    padded = np.pad(corners, 1, mode="edge")
    found: Array = np.maximum(np.maximum(padded[:-2], padded[2:]), corners)
    return found
