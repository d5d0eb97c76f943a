"""Estimation of the motion from position and velocity records.

A friction law requires the speed, its sign and the acceleration. A recorded speed is noisy, and a
recorded angle is quantised by the encoder. A fixed-interval smoother (`smoothing`) estimates the
motion and its standard errors from both records.

Records of real machines have further defects. Positions may not be quantised, speeds may be
filtered differences that contradict the positions, the noise may be heteroscedastic, and the speed
may not be zero at rest. Each defect is detected from the record itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from jbf._core import MotionErrorChain
from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.records.angles import continuous
from jbf.records.checks import frozen
from jbf.records.findings.finding import Finding
from jbf.records.motion.agreement import contradiction_of
from jbf.records.motion.corrected_records import (
    NOT_AS_RECORDED,
    CorrectedRecords,
    corrected_records,
)
from jbf.records.motion.even_clock import even_clock
from jbf.records.motion.first_stroke import begins_with_oscillation
from jbf.records.motion.position import recorded_position
from jbf.records.motion.reading_errors import is_even
from jbf.records.motion.readings import AT_REST, ReadingErrors, Readings
from jbf.records.motion.rests import (
    backward_near_rest,
    certain_rests,
    rest_edges,
    resting_samples,
    still_samples,
    uncertain_near_rest,
    without_swings,
)
from jbf.records.motion.roughness import local_noise, noise_of, quantum_of
from jbf.records.motion.smoothing import Smoothed, smooth
from jbf.records.run import Run

SIGN_SIGMA = 4.0
"""Smallest ratio of a speed to its standard error at which its sign is known."""
EXACT = 1e-6
"""Smallest relative standard error of a reading.

For a velocity it is relative to the largest one; for a position, to the largest displacement in one
step.
"""
WORTH = 0.1
"""Smallest delay of the velocity, in samples, that is reported."""
AT_REST_SIGMA = 3.0
"""Number of standard errors within which a speed next to a rest is zero."""
GONE = 3.0
"""Displacement from a rest, in standard errors of the position, with a known direction."""


@dataclass(frozen=True, eq=False)
class MotionErrors:
    """Joint errors of position and derivatives, a Markov chain over n instants.

    Attributes
    ----------
    covariance
        Covariance at each instant, shape (n, N, N), in powers of m (or rad) and s; N is 3, up to
        the acceleration, or 4.
    gain
        Regression of the errors at an instant on those at the next one, shape (n - 1, N, N).
    arm_m
        Metres of path per radian of the angle; 1 if the path is the angle.
    velocity_delay_s
        Delay of the velocity relative to the position, s.
    smoothed
        The posterior that the errors were taken from.
    """

    covariance: Array
    gain: Array
    arm_m: float
    velocity_delay_s: float = 0.0

    smoothed: Smoothed | None = None

    def at(self, instants_s: Array) -> tuple[Array, MotionErrors]:
        """Position and derivatives at other instants, shape (n, N), and their errors."""
        assert self.smoothed is not None
        mean, covariance, gain = self.smoothed.at(instants_s)
        return mean, replace(self, covariance=covariance, gain=gain)

    @cached_property
    def chain(self) -> MotionErrorChain:
        """The errors as an input of the compiled core."""
        return MotionErrorChain(self.covariance, self.gain)

    def __getstate__(self) -> dict[str, Any]:
        """Return the state for pickling, without the object of the compiled core."""
        return {name: value for name, value in vars(self).items() if name != "chain"}


@dataclass(frozen=True)
class EstimatedMotion:
    """Estimated motion of a run, the input of a model; all arrays have shape (n,).

    Attributes
    ----------
    velocity, acceleration, angle_rad
        Estimates at the samples, m/s, m/s^2 and rad (for a slide, `angle_rad` is the position in
        m).
    velocity_error_m_s
        Standard error of the speed.
    resting
        True at samples at which the shaft was at rest.
    sign_known
        False at samples at which the sign of the motion, and thus of the friction, is unknown, or
        at which the records of path and speed contradict one another.
    findings
        Recording artefacts of path and speed, with the actions taken.
    errors
        Joint errors of the motion; None if unknown.
    clock_s
        Instants of the even clock estimated from the time stamps, s; None if the time stamps are
        used unchanged.
    """

    velocity: Array
    acceleration: Array
    angle_rad: Array
    velocity_error_m_s: Array
    resting: Mask
    sign_known: Mask
    findings: tuple[Finding, ...] = ()
    errors: MotionErrors | None = None
    clock_s: Array | None = None

    @property
    def slides(self) -> Mask:
        """Mask of the samples at which the direction of sliding is known, shape (n,).

        At rest, friction balances the force of the drive up to the breakaway level in either
        direction. The residual is therefore undefined there, and near a reversal.
        """
        return np.asarray(self.sign_known & ~self.resting)

    @property
    def aside(self) -> set[str]:
        """Names of the columns that were discarded as a whole, or converted."""
        return {finding.channel for finding in self.findings if finding.kind in NOT_AS_RECORDED}

    def with_posterior(self, time_s: Array, smoothed: Smoothed) -> EstimatedMotion:
        """Return the motion with another posterior of the same readings.

        Parameters
        ----------
        time_s
            The instants of this motion, s.
        """
        assert self.errors is not None
        mean, errors = replace(self.errors, smoothed=smoothed).at(time_s)
        velocity = np.where(self.resting, 0.0, mean[:, 1])
        # As in `estimate_motion`: with an unknown first sign a model starts at rest.
        if len(velocity) and not self.sign_known[0]:
            velocity[0] = 0.0
        return replace(
            self,
            velocity=velocity,
            acceleration=np.where(self.resting, 0.0, mean[:, 2]),
            angle_rad=mean[:, 0] / errors.arm_m,
            errors=errors,
        )

    def at(self, time_s: Array, instants_s: Array) -> EstimatedMotion:
        """Interpolate the motion to other instants within the record.

        The result is the posterior mean if available, and otherwise a cubic Hermite interpolation
        of speed and acceleration. Next to a rest, the speed is interpolated linearly.

        Parameters
        ----------
        time_s
            The instants of this motion, s.
        """
        k = np.clip(np.searchsorted(time_s, instants_s) - 1, 0, len(time_s) - 2)
        h = time_s[k + 1] - time_s[k]
        u = np.clip((instants_s - time_s[k]) / h, 0.0, 1.0)
        v0, v1 = self.velocity[k], self.velocity[k + 1]
        a0, a1 = self.acceleration[k], self.acceleration[k + 1]
        rest = self.resting[k] & self.resting[k + 1]
        # Next to a rest, the speed is linear between the rest and the first or last motion.
        corner = self.resting[k] | self.resting[k + 1]
        from_s, to_s = time_s[k].copy(), time_s[k + 1].copy()
        with np.errstate(divide="ignore", invalid="ignore"):
            starts = (v0 == 0.0) & corner & (v1 * a1 > 0.0)
            from_s = np.where(starts, np.maximum(to_s - v1 / a1, from_s), from_s)
            ends = (v1 == 0.0) & corner & (v0 * a0 < 0.0)
            to_s = np.where(ends, np.minimum(from_s - v0 / a0, to_s), to_s)
            gone = np.clip((instants_s - from_s) / (to_s - from_s), 0.0, 1.0)
        line = v0 + np.where(to_s > from_s, gone, u) * (v1 - v0)
        rest |= corner & (line == 0.0)
        cubic = (
            (1.0 + 2.0 * u) * (1.0 - u) ** 2 * v0
            + u * (1.0 - u) ** 2 * h * a0
            + u**2 * (3.0 - 2.0 * u) * v1
            - u**2 * (1.0 - u) * h * a1
        )
        velocity = np.where(corner, line, cubic)
        acceleration = np.where(corner, np.where(self.resting[k], a1, a0), a0 + u * (a1 - a0))
        known = self.sign_known[k] & self.sign_known[k + 1] & (v0 * v1 >= 0.0)
        between = np.abs(u - 0.5) < 0.5
        at_sample = np.where(u < 0.5, self.sign_known[k], self.sign_known[k + 1])
        known = np.where(between, known & (rest | ~corner), at_sample)
        angle, errors = np.interp(instants_s, time_s, self.angle_rad), self.errors
        if errors is not None and errors.smoothed is not None:
            mean, errors = errors.at(np.clip(instants_s, time_s[0], time_s[-1]))
            at_samples = corner | (u == 0.0) | (u == 1.0)
            velocity = np.where(at_samples, velocity, mean[:, 1])
            acceleration = np.where(at_samples, acceleration, mean[:, 2])
            angle = np.where(at_samples, angle, mean[:, 0] / errors.arm_m)
        return replace(
            self,
            velocity=np.where(rest, 0.0, velocity),
            acceleration=np.where(rest, 0.0, acceleration),
            angle_rad=angle,
            velocity_error_m_s=np.maximum(
                self.velocity_error_m_s[k], self.velocity_error_m_s[k + 1]
            ),
            resting=rest,
            sign_known=known.astype(bool),
            errors=errors,
        )


def estimate_motion(
    run: Run, radius_m: float | None, starts: Sequence[ReadingErrors] = ()
) -> EstimatedMotion:
    """Estimate the motion of a run.

    Parameters
    ----------
    run
        The record; its angle or position is used if present, otherwise the speed alone.
    radius_m
        Journal radius, m, which converts the angle into a path. None if it is unknown. A position
        then defines a linear axis, which is equivalent to a rotary one of radius 1 m, and an angle
        gives no information on the speed.
    starts
        Reading errors of other runs of the same logger: further starting values for the estimation.
    """
    if run.steady:
        return _steady(run)
    clock_s = _clock(run, radius_m)
    stamps_s = None
    if clock_s is not None:
        stamps_s, run = run.time_s, replace(run, time_s=frozen(clock_s))
    records = corrected_records(run, radius_m, stamps_s)
    time, path, speed, step = run.time_s, records.path, records.speed, records.step
    n = len(time)
    rest = resting_samples(speed) if records.speed_measured else np.zeros(n, dtype=bool)
    if path is not None:
        rest |= still_samples(time, path, speed, step, records.hum)
    readings = _readings(records, time, rest)
    contradiction = np.zeros(n)
    if n > 1 and path is not None and records.speed_measured:
        sd_path, sd_speed = (
            max(noise_of(signal[~rest], time[~rest]), float(np.sqrt(floor)))
            for signal, floor in (
                (path, readings.position_floor),
                (speed, readings.velocity_floor),
            )
        )
        contradiction = contradiction_of(time, path, speed, sd_path, sd_speed)
        readings = replace(
            readings, velocity_shape=np.hypot(readings.velocity_shape, contradiction / sd_speed)
        )
    smoothed = smooth(readings, starts)
    errors = smoothed.errors
    smooth_path = smoothed.mean[:, 0]
    sd = np.sqrt(np.maximum(smoothed.covariance[:, 1, 1], 0.0))
    moves_in_rest = rest & ~certain_rests(rest) & (np.abs(smoothed.mean[:, 1]) > AT_REST_SIGMA * sd)
    rest &= ~moves_in_rest
    velocity, acceleration = np.where(rest, 0.0, smoothed.mean[:, 1:3].T)
    error = np.where(rest, 0.0, sd)
    sign_known = rest | (np.abs(velocity) > SIGN_SIGMA * error)
    # The smoother spreads starts and stops into rests. Where the recorded speed is zero, although
    # its quantisation would resolve the smoothed speed, the direction is unknown.
    if records.speed_measured:
        resolved = np.abs(velocity) > np.sqrt(3.0 * readings.velocity_floor)
        sign_known &= ~((speed == 0.0) & resolved)
    sign_known &= contradiction == 0.0
    sign_known &= ~rest_edges(rest, time, velocity, acceleration)
    sign_known &= ~backward_near_rest(rest, time, velocity, acceleration) & ~records.loose
    if path is not None and not records.speed_measured:
        sign_known &= ~uncertain_near_rest(
            rest, path, velocity, GONE * np.sqrt(errors.position_variance)
        )
    without_swings(rest, velocity, sign_known)
    # A run that begins in motion begins with a deflected contact. Noise at standstill is not
    # motion: with an unknown sign, models start at rest.
    if n and begins_with_oscillation(time, velocity):
        sign_known[0] = False
    if n and not sign_known[0]:
        velocity[0] = 0.0
    angle = smooth_path / (radius_m or records.arm_m)
    if records.path is None and radius_m is None and run.angle_rad is not None:
        angle = continuous(run.angle_rad)
    return EstimatedMotion(
        velocity,
        acceleration,
        angle,
        error,
        rest,
        sign_known,
        (*records.findings, *_late(run, errors.velocity_delay_s)),
        MotionErrors(
            smoothed.covariance,
            smoothed.gain,
            radius_m or records.arm_m,
            errors.velocity_delay_s,
            smoothed,
        ),
        clock_s,
    )


def _steady(run: Run) -> EstimatedMotion:
    """Motion of steady states: their speeds, without acceleration and path."""
    if not run.speed_recorded:
        raise InputError(
            file=run.path or run.name,
            column="velocity_m_s",
            problem="is missing, and steady states require a speed",
            remedy="add the speed of each point",
        )
    zeros, rest = np.zeros(len(run)), run.velocity == 0.0
    return EstimatedMotion(run.velocity, zeros, zeros, zeros, rest, ~rest)


def _clock(run: Run, radius_m: float | None) -> Array | None:
    """Instants of an even sampling clock, s; None if the time stamps are used unchanged."""
    # With separate clocks, the time stamps of the force differ from those of the motion.
    even_s = None if run.read else even_clock(run.time_s)
    if even_s is None:
        return None
    position = recorded_position(run, radius_m)
    n, missing = len(even_s), np.full(len(even_s), np.nan)
    if position is None and not run.speed_recorded:
        return None
    signal = run.velocity if position is None else position.path_m
    floor = max(quantum_of(signal) ** 2 / 12.0, (EXACT * float(np.ptp(signal)) / n) ** 2, 1e-30)
    path, speed = (missing, signal) if position is None else (signal, missing)
    readings = Readings(run.time_s, path, speed, floor, floor, np.ones(n), np.ones(n))
    return even_s if is_even(readings, even_s) else None


def _late(run: Run, delay_s: float) -> list[Finding]:
    """Finding that the velocity is delayed relative to the position; empty for a small delay."""
    if abs(delay_s) < WORTH * float(np.median(np.diff(run.time_s))):
        return []
    way = "later" if delay_s > 0.0 else "earlier"
    words = f"the speed is {1e3 * abs(delay_s):.3g} ms {way} than the position"
    return [Finding("late_speed", "velocity_m_s", run.name, delay_s, "s", "corrected", words)]


def _readings(records: CorrectedRecords, time: Array, rest: Mask) -> Readings:
    """Readings of position and velocity for the smoother, with their smallest possible errors."""
    n, path, speed = len(time), records.path, records.speed
    sure = certain_rests(rest)
    position, velocity = np.full(n, np.nan), np.where(sure, 0.0, np.nan)
    top, position_step = float(np.max(np.abs(speed), initial=0.0)), 0.0
    way = top * float(np.median(np.diff(time))) if n > 1 else top
    position_shape: Array = np.ones(n)
    if path is not None:
        position, position_step = path, quantum_of(path)
        # All readings during a rest count as one reading.
        edges = np.diff(np.concatenate(([0], rest.astype(np.int8), [0])))
        for first, end in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
            position_shape[first:end] = np.sqrt(end - first)
    velocity_step, velocity_shape = 0.0, np.ones(n)
    if records.speed_measured:
        velocity, velocity_step = np.where(sure, 0.0, speed), quantum_of(speed[~rest])
        local, usual = local_noise(speed[~rest]), noise_of(speed[~rest])
        if usual > 0.0:
            velocity_shape[~rest] = local / usual
    return Readings(
        time,
        position,
        velocity,
        max(position_step**2 / 12.0, (EXACT * way) ** 2, 1e-30),
        max(velocity_step**2 / 12.0, (EXACT * top) ** 2, 1e-30),
        position_shape,
        np.where(sure, AT_REST, velocity_shape),
    )
