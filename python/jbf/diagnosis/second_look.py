"""A second look at the samples, once a first round of selection has said what the model is.

Where the noise grows with the force or differs by run, and where its tails are heavy, the first
likelihood was not the data's. What the residuals of the first answer tell of that goes into the
samples as weights. Then selection begins anew. (Runs that deviate from one another are asked for in
each round of selection: `deviations`.)
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.policy import Policy
from jbf.diagnosis.uneven_noise import noise_sizes, robust_weights
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]

EVALUATIONS = 8
"""Steps of a fit that shows where weights lead."""


@dataclass(frozen=True, eq=False)
class SecondLook:
    """What the residuals of a first answer tell of the noise."""

    campaign: Campaign
    found: bool


def second_look(problem: Problem, solution: Solution, policy: Policy) -> SecondLook:
    """The campaign weighed as the residuals of a solution ask for it."""
    campaign = problem.campaign
    known = {f.kind for f in campaign.more_findings}
    ones = [np.ones(len(r)) for r in solution.residuals]
    sizes, robust = ones, ones
    found: list[Finding] = []

    def keeps(samples: Samples) -> bool:
        return _keeps(problem, solution, samples, policy.no_worse)

    # Weights are given once.
    if not known & {"noise_with_force", "noise_by_run"}:
        shares, uneven = noise_sizes(problem, solution, policy)
        if uneven and _keeps(
            problem, solution, campaign.samples.weighed(shares, ones, None), policy.no_worse
        ):
            sizes, found = shares, uneven
    if "heavy_tails" not in known and campaign.step_n < policy.coarse_steps * solution.rms_n:
        shares, heavy = robust_weights(solution, sizes, policy.heavy_tails)
        if heavy and _keeps(
            problem, solution, campaign.samples.weighed(sizes, shares, None), policy.no_worse
        ):
            robust, found = shares, [*found, *heavy]
    if not found:
        return SecondLook(campaign, False)
    samples = campaign.samples.weighed(sizes, robust, campaign.samples.between)
    again = replace(campaign, samples=samples).with_findings(found)
    return SecondLook(again, True)


def _keeps(problem: Problem, solution: Solution, samples: Samples, most: float) -> bool:
    """Whether a fit on these samples still predicts as well as before where all count alike.

    Of noise alone it does, whatever the weights. Where a model is wrong its error passes for noise,
    and weights would give up what they call so.
    """
    moved = samples.within(solution.samples.counted)
    values = search(problem, moved, solution.values, solution.noise, EVALUATIONS).values
    before = solution.samples.rms(solution.residuals)
    return solution.samples.rms(problem.residuals(values)) <= most * before
