"""A term of the observation model at its estimate, and the criterion by which it is accepted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import special

from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import left_out_by_run
from jbf.estimation.likelihood import effective_share
from jbf.estimation.long_run import sure_inflation
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution

KINDS = 10
"""Number of terms among which the probability of a false one is shared: offset, drift, gain and oil
by run, delay by run, clock drift, quantiser, variance by force and by run, heavy tails."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """A term of the observation model, estimated together with the parameters of a model.

    Attributes
    ----------
    term
        Its name.
    campaign
        The campaign with the term.
    problem, solution
        The fit with the term.
    gain
        Increase of twice the log marginal likelihood, corrected for the autocorrelation of the
        residuals.
    price
        Least increase at which the term is accepted.
    """

    term: str
    campaign: Campaign
    problem: Problem
    solution: Solution
    gain: float
    price: float

    @property
    def evidence(self) -> float:
        """Gain less price, comparable with the evidence for an effect."""
        return self.gain - self.price


@dataclass(frozen=True, eq=False)
class Model:
    """A fitted model beside which a term is estimated.

    Attributes
    ----------
    problem, solution
        Its fit.
    before
        The fit that the term is compared with: this one, or that of a model with more effects,
        which the term would replace.
    price_of_effect
        Price of the first parameter of an effect.
    """

    problem: Problem
    solution: Solution
    before: Solution
    policy: Policy = DEFAULT
    price_of_effect: float = 0.0

    @classmethod
    def of(cls, problem: Problem, solution: Solution, policy: Policy = DEFAULT) -> Model:
        """A model that is compared with itself."""
        return cls(problem, solution, solution, policy)

    @property
    def campaign(self) -> Campaign:
        """The campaign with the terms accepted so far."""
        return self.problem.campaign


class Term(Protocol):
    """Estimates one kind of term beside a model."""

    def __call__(self, model: Model) -> Proposal | None:
        """The term at its estimate; None if the runs do not show it."""


def price_of_term(policy: Policy, parameters: int = 1) -> float:
    """Increase of twice the log likelihood that noise exceeds with the probability of one term."""
    return float(special.chdtri(parameters, policy.deviation_chance / KINDS))


def independent_samples(after: Solution, before: Solution) -> float:
    """Number of independent samples a sample counts for in the gain of a term, 0 to 1; the same
    measure as for an effect (`share_of_gain`)."""
    left, was = (s.samples.weighted_innovations(s.residuals, after.noise) for s in (after, before))
    ways = [b - e for b, e in zip(was, left, strict=True)]
    return min(effective_share(after), 1.0 / sure_inflation(ways, left, after.samples.steps_s))


def accepted(proposal: Proposal | None, model: Model, least: float = 0.0) -> bool:
    """Whether the evidence for a term exceeds a least one, and runs left out of the fit confirm
    it."""
    if proposal is None or proposal.evidence <= max(least, 0.0):
        return False
    return not predicts_worse(proposal, model)


def predicts_worse(proposal: Proposal, model: Model) -> bool:
    """Whether runs left out of the fit are predicted worse with a term, by more than the
    policy's ratio and the standard error of its mean over the runs.

    Every run has the same weight: where runs deviate from one another, the largest deviation must
    not decide alone.
    """
    fits = ((proposal.problem, proposal.solution), (model.problem, model.solution))
    rms = [
        np.array([np.sqrt(np.mean(e**2)) if len(e) else np.nan for e in left_out_by_run(*fit)])
        for fit in fits
    ]
    ratio = np.log(np.maximum(rms[0], 1e-300) / np.maximum(rms[1], 1e-300))
    ratio = ratio[np.isfinite(ratio)]
    if not len(ratio):
        return False
    error = float(np.std(ratio, ddof=1)) / np.sqrt(len(ratio)) if len(ratio) > 1 else 0.0
    return bool(np.mean(ratio) - error > np.log(model.policy.no_worse))
