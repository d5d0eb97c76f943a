"""Campaigns of drives with the errors of their motion in the likelihood."""

from __future__ import annotations

from dataclasses import replace

from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.selection import start_model
from jbf.errors import Unfinished
from jbf.estimation.campaign import Campaign
from jbf.estimation.refine import with_motion_errors
from jbf.models.vocabulary import Clock

SIMPLEST = "coulomb"
"""The law with the fewest parameters."""


def with_errors_of_motion(candidates: Candidates) -> Campaign | None:
    """Return the campaign of a drive with the errors of its motion in the likelihood.

    Its force is corrected by a time delay common to all runs. Returns None for a rig without a
    drive, or where these errors are negligible.
    """
    if candidates.campaign.rig.drive is None:
        return None
    base = start_model(candidates)
    problem, solution = candidates.fitted(base).problem, candidates.converge(base)
    problem, solution = with_motion_errors(problem, solution)
    if solution.samples.motion is None:
        return None
    campaign = problem.campaign
    return replace(campaign, samples=replace(campaign.samples, motion=solution.samples.motion))


def comparable(campaign: Campaign, clock: Clock, policy: Policy) -> Campaign:
    """Return the campaign with motion errors estimated by the simplest law, for comparing laws."""
    if campaign.rig.drive is None:
        return campaign
    own = replace(campaign, work=campaign.work.part(1.0))
    try:
        return with_errors_of_motion(Candidates(own, SIMPLEST, clock, policy)) or campaign
    except Unfinished:
        return campaign
