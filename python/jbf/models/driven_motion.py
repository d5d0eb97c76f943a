"""A run's motion as the core takes it: between the samples, too, where friction jumps.

A motion sets in, and ends, between two samples: when, its acceleration tells, and a step of the
core ends there. Where an effect makes the record late the core keeps the force at the ends of its
steps, with straight lines between: in a fit a jump is a ramp with a slope, in a prediction a sample
within it would be neither what was nor what is. Steps that end close to either side of each jump
make that ramp shorter than any sample.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.models.chain import core_motion
from jbf.models.driven import Driven
from jbf.records.findings.noisy_load import steady_load
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.rig import Rig
from jbf.records.run import Run

Array = npt.NDArray[np.float64]

BESIDE = 0.02
"""Share of the delay so close to a jump; a delay line keeps steps of a sixtieth apart."""
INSIDE = 1e-3
"""Share of a step that an instant must be off both its ends."""


def driven_motion(rig: Rig, run: Run, motion: ImposedMotion, *, delay_s: float = 0.0) -> Driven:
    """A run's motion for the core.

    Parameters
    ----------
    delay_s
        How late the record of the force is, s, for jumps that stay sharp; zero in a fit.
    """
    time, v = run.time_s, motion.velocity_m_s
    zero, starts = _zeros(time, v, motion.acceleration_m_s2)
    new, speed = zero[starts], np.zeros(int(starts.sum()))
    if delay_s > 0.0:
        lines = np.argsort(np.concatenate([time, new]))
        knots = np.concatenate([time, new])[lines], np.concatenate([v, speed])[lines]
        beside = np.concatenate([zero - BESIDE * delay_s, zero + BESIDE * delay_s])
        new = np.concatenate([new, beside])
        speed = np.concatenate([speed, np.interp(beside, *knots)])
    inside = (new > time[0]) & (new < time[-1]) & ~np.isin(new, time)
    if not inside.any():
        return core_motion(rig, run, motion)
    whole, first = np.unique(np.concatenate([time, new[inside]]), return_index=True)
    velocity = np.concatenate([v, speed[inside]])[first]
    if run.load_n is not None:
        # Lines drawn through its noise would not be white any more.
        run = replace(run, load_n=steady_load(run.load_n))
    before = np.searchsorted(time, whole, side="right") - 1
    there = replace(
        motion,
        velocity_m_s=velocity,
        acceleration_m_s2=np.interp(whole, time, motion.acceleration_m_s2),
        angle_rad=np.interp(whole, time, motion.angle_rad),
        velocity_error_m_s=motion.velocity_error_m_s[before],
        resting=motion.resting[before],
        sign_known=motion.sign_known[before],
    )
    friction = np.zeros(len(whole)) if run.friction_n is None else run.friction_n[before]
    driven = core_motion(rig, run.at(whole, friction), there)
    return Driven(driven.motion, np.searchsorted(whole, time))


def _zeros(time: Array, v: Array, a: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Instants at which the speed changes its sign, sets in or ends, s; and True for those of the
    latter two that lie between two samples."""
    k = np.flatnonzero(np.sign(v[:-1]) != np.sign(v[1:]))
    t0, t1, v0, v1 = time[k], time[k + 1], v[k], v[k + 1]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = t0 + (t1 - t0) * v0 / (v0 - v1)
        start = np.where(v1 * a[k + 1] > 0.0, t1 - v1 / a[k + 1], t0)
        stop = np.where(v0 * a[k] < 0.0, t0 - v0 / a[k], t1)
    zero = np.where(v0 == 0.0, start, np.where(v1 == 0.0, stop, crossing))
    zero = np.clip(zero, t0, t1)
    edge = INSIDE * (t1 - t0)
    between = ((v0 == 0.0) | (v1 == 0.0)) & (zero > t0 + edge) & (zero < t1 - edge)
    return zero, between
