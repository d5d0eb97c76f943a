"""Duration of the film's memory of unrecorded motion in a gap.

The model interpolates linearly over missing rows. If the shaft reversed or started in the gap, the
film state after it is wrong until the film has forgotten. Two simulations bound this duration: one
keeps the speed from before the gap until its end; the other has the speed after the gap from its
beginning. They differ as long as the film remembers.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.models.catalogue import find_law
from jbf.models.chain import core_motion
from jbf.models.driven import Driven

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

EDGE = 1e-3
"""Fraction of a gap in which a simulated motion changes its speed. It is a numerical resolution."""


def samples_affected_by_gaps(problem: Problem, values: Array, least_n: float) -> list[Mask]:
    """Mask of the samples at which a run still remembers unrecorded motion, one a run.

    Parameters
    ----------
    values
        Parameters of a model that fits roughly.
    least_n
        Difference of the friction that is negligible, N.
    """
    prepared = problem.campaign.prepared
    found = [np.zeros(len(p.run), dtype=bool) for p in prepared]
    if not find_law(problem.law).has_film:
        return found
    gap_steps = problem.campaign.settings.film.gap_steps
    gaps = [_gaps(p, gap_steps) for p in prepared]
    broken = [i for i, at in enumerate(gaps) if len(at)]
    usual = problem.chain.predict(values, [prepared[i].core for i in broken])
    for late in (False, True):
        motions = [_through(prepared[i], gaps[i], late=late) for i in broken]
        others = problem.chain.predict(values, motions)
        for i, one, other in zip(broken, usual, others, strict=True):
            found[i] |= np.abs(other - one) > least_n
    return found


def _gaps(p: Prepared, gap_steps: float) -> npt.NDArray[np.intp]:
    """Indices of the last samples before gaps."""
    return np.flatnonzero(np.diff(p.run.time_s) > gap_steps * p.step_s)


def _through(p: Prepared, gaps: npt.NDArray[np.intp], *, late: bool) -> Driven:
    """Motion of a run whose speed changes at the end of each gap (`late`) or at its beginning."""
    time = p.run.time_s
    length = time[gaps + 1] - time[gaps]
    new = time[gaps + 1] - EDGE * length if late else time[gaps] + EDGE * length
    speed = p.motion.velocity[gaps if late else gaps + 1]
    whole = np.sort(np.concatenate([time, new]))
    motion = p.motion.at(time, whole)
    velocity, acceleration = motion.velocity.copy(), motion.acceleration.copy()
    at = np.searchsorted(whole, new)
    velocity[at], acceleration[at] = speed, 0.0
    motion = replace(motion, velocity=velocity, acceleration=acceleration)
    run = p.run.at(whole, np.interp(whole, time, p.friction))
    return Driven(core_motion(p.rig, run, motion).motion, np.searchsorted(whole, time))
