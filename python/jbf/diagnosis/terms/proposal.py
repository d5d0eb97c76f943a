"""Estimated term of the observation model, and the criterion for its acceptance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import special

from jbf.diagnosis.policy import Policy
from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out import held_out_by_run
from jbf.estimation.likelihood import effective_share, noise_at
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.estimation.variance import significant_inflation

EVALUATIONS = 8
"""Number of evaluations of a fit with a term. It limits the effort only."""


@dataclass(frozen=True, eq=False)
class Proposal:
    """A term of the observation model, estimated together with the parameters of a model.

    Attributes
    ----------
    campaign
        The campaign with the term.
    problem, solution
        The fit with the term.
    gain
        Increase of twice the log marginal likelihood of the independent samples.
    price
        Threshold for the gain, less the thresholds of the effects that the term replaces.
    compute_held_out_gain
        Function that returns the increase of twice the log density of held-out runs; None for terms
        that are judged by the RMS errors of held-out runs instead.
    """

    campaign: Campaign
    problem: Problem
    solution: Solution
    gain: float
    price: float
    compute_held_out_gain: Callable[[], float] | None = None

    @property
    def evidence(self) -> float:
        """Gain minus threshold, comparable with the evidence for an effect."""
        return self.gain - self.price


@dataclass(frozen=True, eq=False)
class Model:
    """A fitted model for which a term is estimated.

    Attributes
    ----------
    problem, solution
        Fit of the model.
    reference_problem, reference
        Fit with which the term is compared: the fit of the model, or of a model with additional
        effects that the term would replace.
    policy
        Thresholds of the decision.
    price_of_effect
        Threshold for the gain of an effect with one parameter.
    """

    problem: Problem
    solution: Solution
    reference_problem: Problem
    reference: Solution
    policy: Policy
    price_of_effect: float

    @property
    def campaign(self) -> Campaign:
        """Campaign with the terms that were accepted so far."""
        return self.problem.campaign


Term = Callable[[Model], Proposal | None]
"""Estimator of one kind of term for a model; None if not identifiable or not significant."""


def price_of_term(policy: Policy, parameters: int = 1) -> float:
    """Gain that a term with this number of parameters must exceed (likelihood-ratio test).

    The threshold is the upper chi-square quantile at the false-term probability, with a Bonferroni
    correction for the kinds of terms.
    """
    return float(special.chdtri(parameters, policy.terms.chance / policy.terms.kinds))


def independent_fraction(after: Solution, before: Solution) -> float:
    """Effective number of samples in the gain of a term, divided by the number of samples.

    It differs from that of an effect (`share_of_gain`): each model has its own samples and random
    effects, since a term changes them.
    """
    after_errors, before_errors = (
        s.samples.weighted_innovations(s.residuals, after.noise) for s in (after, before)
    )
    differences = [b - e for b, e in zip(before_errors, after_errors, strict=True)]
    settings = after.samples.settings.variance
    inflation = significant_inflation(differences, after_errors, after.samples.steps_s, settings)
    return min(effective_share(after), 1.0 / inflation)


def is_accepted(proposal: Proposal | None, model: Model, min_evidence: float = 0.0) -> bool:
    """Whether a proposed term has sufficient evidence and does not increase the held-out error.

    The error increases if the mean log ratio over the runs exceeds the limit of the policy by more
    than its standard error. All runs have equal weight, so that with between-run variance the
    largest deviation does not dominate. Delays and the quantisation bias are those of the fit to
    all runs. A term that changes the covariance of the errors must not decrease the density of
    held-out runs; a change that is not a number counts as a decrease.
    """
    if proposal is None or proposal.evidence <= max(min_evidence, 0.0):
        return False
    if proposal.compute_held_out_gain is not None:
        return proposal.compute_held_out_gain() >= 0.0
    fits = ((proposal.problem, proposal.solution), (model.reference_problem, model.reference))
    rms = [
        np.array([np.sqrt(np.mean(e**2)) if len(e) else np.nan for e in held_out_by_run(*fit)])
        for fit in fits
    ]
    ratio = np.log(np.maximum(rms[0], 1e-300) / np.maximum(rms[1], 1e-300))
    ratio = ratio[np.isfinite(ratio)]
    if not len(ratio):
        return True
    error = float(np.std(ratio, ddof=1)) / np.sqrt(len(ratio)) if len(ratio) > 1 else 0.0
    return bool(np.mean(ratio) - error <= np.log(model.policy.held_out.no_worse_ratio))


def refitted(problem: Problem, near: Solution, samples: Samples) -> Solution:
    """Refit a model by a few steps with other sample weights or correlations, and its noise."""
    values = search(problem, samples, near.values, near.noise, EVALUATIONS).values
    return problem.solution(values, samples, noise_at(problem, samples, values))
