"""Loggers: clocks, time stamps, counts, filtered and differenced velocities, torque channels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from servosim.plant import Trajectory

Array = npt.NDArray[np.float64]

STAMPS = ("even", "jitter", "jittered", "millis", "arrival")
SPEEDS = ("drive", "tacho", "differenced", "none")
FORCES = ("command", "sensor", "quantised")


@dataclass(frozen=True)
class Logger:
    """Recording of the runs of a drive: sampling, channels and their errors.

    Attributes
    ----------
    rate_hz
        Sampling rate.
    stamps
        `even`; `jitter`: samples at uneven instants with true stamps; `jittered`: an even clock
        with wrong stamps; `millis`: whole milliseconds of a loop of another period; `arrival`: an
        even clock, stamped on arrival.
    stamp_share
        Size of the error of the stamps, sampling intervals.
    speed
        `drive`: a filtered difference of counts; `tacho`: with noise; `differenced`: computed by
        the logger from the recorded positions; `none`.
    filter_s
        Time constant of the drive's filter, s.
    speed_noise
        Standard deviation of the tachometer.
    speed_late, force_late
        Delays of the velocity and force readings, sampling intervals.
    count
        Step of the encoder, rad or m.
    force
        `command`: the controller's command; `sensor`: with noise; `quantised`: in steps, with
        noise.
    force_noise, force_step
        Standard deviation and quantisation step of the force reading.
    """

    rate_hz: float
    stamps: str
    stamp_share: float
    speed: str
    filter_s: float
    speed_noise: float
    speed_late: float
    force_late: float
    count: float
    force: str
    force_noise: float
    force_step: float


@dataclass(frozen=True)
class Recorded:
    """Recorded run with arrays of shape (n,); `velocity` is None if it was not recorded."""

    time_s: Array
    position: Array
    velocity: Array | None
    force: Array
    true_velocity: Array
    true_acceleration: Array


def record(
    logger: Logger, motion: Trajectory, tick_s: float, random: np.random.Generator
) -> Recorded:
    """Record a trajectory with a logger."""
    period = 1.0 / logger.rate_hz
    margin = 2.0 * period + 5.0 * logger.filter_s + 0.01
    n = int((motion.time[-1] - 2.0 * margin) / period)
    even = margin + period * (np.arange(n) + random.uniform())
    true, stamps = even, even
    error = logger.stamp_share * period
    if logger.stamps in ("jitter", "jittered"):
        moved = even + np.clip(random.normal(0.0, error, n), -0.45 * period, 0.45 * period)
        true, stamps = (moved, moved) if logger.stamps == "jitter" else (even, moved)
    elif logger.stamps == "millis":
        stamps = np.floor(1e3 * even) / 1e3
    elif logger.stamps == "arrival":
        delays = random.exponential(error, n)
        delays[random.random(n) < 0.005] += 2.0 * period
        # Messages arrive one after another, at least 10 us apart.
        order = 1e-5 * np.arange(n)
        stamps = np.maximum.accumulate(even + delays - order) + order
    x, v, a, _ = motion.at(true)
    position = np.round(x / logger.count) * logger.count
    velocity = _velocity(logger, motion, true, stamps, position, tick_s, random)
    force = motion.at(true - logger.force_late * period)[3]
    if logger.force != "command":
        force = force + random.normal(0.0, logger.force_noise, n)
    if logger.force == "quantised":
        force = np.round(force / logger.force_step) * logger.force_step
    return Recorded(stamps - stamps[0], position, velocity, force, v, a)


def _velocity(
    logger: Logger,
    motion: Trajectory,
    true: Array,
    stamps: Array,
    position: Array,
    tick_s: float,
    random: np.random.Generator,
) -> Array | None:
    if logger.speed == "none":
        return None
    if logger.speed == "differenced":
        steps = np.maximum(np.diff(stamps), 1e-6)
        return np.concatenate(([0.0], np.diff(position) / steps))
    at = true - logger.speed_late / logger.rate_hz
    if logger.speed == "tacho":
        return motion.at(at)[1] + random.normal(0.0, logger.speed_noise, len(true))
    ticks = np.arange(0.0, motion.time[-1], tick_s)
    counted = np.round(motion.at(ticks)[0] / logger.count) * logger.count
    raw = np.diff(counted, prepend=counted[0]) / tick_s
    keep = np.exp(-tick_s / logger.filter_s)
    from scipy.signal import lfilter

    filtered = lfilter([1.0 - keep], [1.0, -keep], raw)
    last = np.clip(np.floor(at / tick_s).astype(int), 0, len(ticks) - 1)
    return np.asarray(filtered[last])
