"""How long a record remembers what nobody recorded: the motion within a gap.

A model steps over missing rows in a straight line. Where the shaft turned round or set out
meanwhile the film behind the gap is another, until it has forgotten: runs of the model that keep
the speed from before the gap until its end, or have the speed behind it from its beginning, differ
by what is still remembered.
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

GAP = 4.5
"""A step so many times the usual one hides more of a motion than a line can follow."""
EDGE = 1e-3
"""Share of a gap in which an imagined motion changes its speed."""


def behind_gaps(problem: Problem, values: Array, least_n: float) -> list[Mask]:
    """True where a run still remembers a motion that was not recorded, one mask a run.

    Parameters
    ----------
    values
        Parameters of a model that fits roughly.
    least_n
        A difference of the friction that does not matter, N.
    """
    prepared = problem.campaign.prepared
    found = [np.zeros(len(p.run), dtype=bool) for p in prepared]
    if not find_law(problem.law).has_film:
        return found
    broken = [i for i, p in enumerate(prepared) if len(_gaps(p))]
    usual = problem.chain.predict(values, [prepared[i].core for i in broken])
    for late in (False, True):
        motions = [_through(prepared[i], late=late) for i in broken]
        others = problem.chain.predict(values, motions)
        for i, one, other in zip(broken, usual, others, strict=True):
            found[i] |= np.abs(other - one) > least_n
    return found


def _gaps(p: Prepared) -> npt.NDArray[np.intp]:
    """The last samples before gaps."""
    return np.flatnonzero(np.diff(p.run.time_s) > GAP * p.step_s)


def _through(p: Prepared, *, late: bool) -> Driven:
    """The motion of a run that changes its speed at the end of each gap (`late`), or its begin."""
    time, gaps = p.run.time_s, _gaps(p)
    length = time[gaps + 1] - time[gaps]
    new = time[gaps + 1] - EDGE * length if late else time[gaps] + EDGE * length
    speed = p.motion.velocity_m_s[gaps if late else gaps + 1]
    whole = np.sort(np.concatenate([time, new]))
    motion = p.motion.at(time, whole)
    velocity, acceleration = motion.velocity_m_s.copy(), motion.acceleration_m_s2.copy()
    at = np.searchsorted(whole, new)
    velocity[at], acceleration[at] = speed, 0.0
    motion = replace(motion, velocity_m_s=velocity, acceleration_m_s2=acceleration)
    run = p.run.at(whole, np.interp(whole, time, p.friction_n))
    return Driven(core_motion(p.rig, run, motion).motion, np.searchsorted(whole, time))
