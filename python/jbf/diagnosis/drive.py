"""Drives: terms of the machine, and errors of the motion.

A motor accelerates its load and carries its weight whatever the friction is. Inertia or mass,
weight and offset belong to the model from which the diagnosis of a drive starts; they are not
missing effects. The errors of the recorded motion are part of the likelihood.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from jbf.diagnosis.candidates import Candidates
from jbf.estimation.campaign import Campaign
from jbf.estimation.generalised_least_squares import with_motion_errors

Names = tuple[str, ...]

OFFSET = "sensor_offset"
TERMS = (OFFSET, "inertia", "gravity")
"""Effects that are not friction and that no law can represent."""


def machine_of(candidates: Candidates, present: Iterable[str]) -> Names:
    """The effects of a model that are terms of its machine; empty for a rig without a drive."""
    if candidates.campaign.rig.drive is None:
        return ()
    return tuple(name for name in present if name in TERMS)


def with_errors_of_motion(candidates: Candidates, base: Names) -> Campaign | None:
    """Return the campaign of a drive with the errors of its motion in the likelihood.

    Its force is corrected by a time delay common to all runs. Returns None for a rig without a
    drive, or where these errors are negligible.

    Parameters
    ----------
    base
        Terms of the drive's machine in the model that estimates the errors.
    """
    if candidates.campaign.rig.drive is None:
        return None
    problem, solution = candidates.fitted(base).problem, candidates.converge(base)
    problem, solution = with_motion_errors(problem, solution)
    if solution.samples.motion is None:
        return None
    campaign = problem.campaign
    return replace(campaign, samples=replace(campaign.samples, motion=solution.samples.motion))
