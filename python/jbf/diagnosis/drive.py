"""Machine terms (inertia, weight, offset) of a drive, and errors of its recorded motion.

A motor accelerates its load and carries its weight, independently of friction. Inertia or mass,
weight and offset are part of the initial model of the diagnosis of a drive; they are not missing
effects. The errors of the recorded motion are part of the likelihood.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from jbf.diagnosis.candidates import Candidates
from jbf.estimation.campaign import Campaign
from jbf.estimation.generalised_least_squares import with_motion_errors
from jbf.records.rig import Rig

Names = tuple[str, ...]

OFFSET = "sensor_offset"
TERMS = (OFFSET, "inertia", "gravity")
"""Effects that are not friction and that no law can represent."""


def machine_of(rig: Rig, present: Iterable[str]) -> Names:
    """Machine terms among the effects `present` in a model; empty for a rig without a drive."""
    return () if rig.drive is None else tuple(name for name in present if name in TERMS)


def with_errors_of_motion(candidates: Candidates, base: Names) -> Campaign | None:
    """Return a drive's campaign with the covariance of the motion's errors in the likelihood.

    The force is corrected by a time delay common to all runs. Returns None for a rig without a
    drive, or if these errors are negligible.

    Parameters
    ----------
    candidates
        Cached fits of the campaign.
    base
        Machine terms of the model with which the errors are estimated.
    """
    if candidates.campaign.rig.drive is None:
        return None
    problem, solution = candidates.fitted(base).problem, candidates.converge(base)
    problem, solution = with_motion_errors(problem, solution)
    if solution.samples.motion is None:
        return None
    campaign = problem.campaign
    return replace(campaign, samples=replace(campaign.samples, motion=solution.samples.motion))
