"""Conversion of a run's motion to the form of the core, with instants at friction jumps.

A motion starts and stops between two samples. The instant is computed from the acceleration, and an
integration step of the core ends at that instant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array
from jbf.models.chain import core_motion
from jbf.models.driven import Driven
from jbf.records.findings.noisy_load import steady_load
from jbf.records.motion.estimated_motion import EstimatedMotion
from jbf.records.rig import Rig
from jbf.records.run import Run

MIN_MARGIN = 1e-3
"""Least distance of an additional instant from both samples, as a share of the step."""
LONGEST_S = 1.0
"""Largest standard error of the instant of a reversal, s."""


@dataclass(frozen=True)
class Reversals:
    """Instants at which a motion reverses, starts or stops.

    Attributes
    ----------
    at_s
        The instants, s, shape (k,).
    sd_s
        Their standard errors, s.
    between
        True for a start or stop of the motion between two samples.
    interval
        Index of the sample before each instant.
    """

    at_s: Array
    sd_s: Array
    between: npt.NDArray[np.bool_]
    interval: npt.NDArray[np.intp]


def driven_motion(rig: Rig, run: Run, motion: EstimatedMotion) -> Driven:
    """Convert the motion of a run to the form of the core (`with_instants`)."""
    return with_instants(rig, run, motion, np.zeros(0))[1]


def with_instants(
    rig: Rig, run: Run, motion: EstimatedMotion, more_s: Array
) -> tuple[Array, Driven]:
    """Convert the motion of a run to the form of the core, with additional instants.

    Returns all instants of the core, s, and the converted motion.

    Parameters
    ----------
    more_s
        Additional instants, s, at which the speed is interpolated linearly.
    """
    time, v = run.time_s, motion.velocity
    turns = reversals(time, motion)
    new = turns.at_s[turns.between]
    speed = np.zeros(len(new))
    if len(more_s):
        lines = np.argsort(np.concatenate([time, new]))
        knots = np.concatenate([time, new])[lines], np.concatenate([v, speed])[lines]
        new = np.concatenate([new, more_s])
        speed = np.concatenate([speed, np.interp(more_s, *knots)])
    inside = (new > time[0]) & (new < time[-1])
    if not inside.any():
        return time, core_motion(rig, run, motion)
    instants, first = np.unique(np.concatenate([time, new[inside]]), return_index=True)
    velocity = np.concatenate([v, speed[inside]])[first]
    if run.load_n is not None:
        # After interpolation the noise of the load would no longer be white.
        run = replace(run, load_n=steady_load(run.load_n))
    before = np.searchsorted(time, instants, side="right") - 1
    extended = replace(
        motion,
        velocity=velocity,
        acceleration=np.interp(instants, time, motion.acceleration),
        angle_rad=np.interp(instants, time, motion.angle_rad),
        velocity_error_m_s=motion.velocity_error_m_s[before],
        resting=motion.resting[before],
        sign_known=motion.sign_known[before],
    )
    friction = np.zeros(len(instants)) if run.friction is None else run.friction[before]
    driven = core_motion(rig, run.at(instants, friction), extended)
    return instants, Driven(driven.motion, np.searchsorted(instants, time))


def reversals(time_s: Array, motion: EstimatedMotion) -> Reversals:
    """Find the instants at which a motion reverses, starts or stops.

    The error of an instant is the error of the speed divided by the acceleration.
    """
    v, a = motion.velocity, motion.acceleration
    k = np.flatnonzero(np.sign(v[:-1]) != np.sign(v[1:]))
    t0, t1, v0, v1 = time_s[k], time_s[k + 1], v[k], v[k + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = t0 + (t1 - t0) * v0 / (v0 - v1)
        start = np.where(v1 * a[k + 1] > 0.0, t1 - v1 / a[k + 1], t0)
        stop = np.where(v0 * a[k] < 0.0, t0 - v0 / a[k], t1)
    zero = np.where(v0 == 0.0, start, np.where(v1 == 0.0, stop, crossing))
    zero = np.clip(zero, t0, t1)
    edge = MIN_MARGIN * (t1 - t0)
    between = ((v0 == 0.0) | (v1 == 0.0)) & (zero > t0 + edge) & (zero < t1 - edge)
    slope = np.maximum(np.maximum(np.abs(a[k]), np.abs(a[k + 1])), np.abs(v1 - v0) / (t1 - t0))
    error = np.maximum(motion.velocity_error_m_s[k], motion.velocity_error_m_s[k + 1])
    sd = error / np.maximum(slope, 1e-12)
    return Reversals(zero, np.minimum(sd, LONGEST_S), between, k)
