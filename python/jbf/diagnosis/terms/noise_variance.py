"""Residual-error model: heteroscedastic noise by force or by run, and heavy tails.

The weights of the samples that this module returns are between 0 and 1, relative to the smallest
noise level.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
from scipy import optimize, special

from jbf.arrays import Array
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.terms.proposal import Model, Proposal, price_of_term, refitted
from jbf.estimation.campaign import Campaign
from jbf.estimation.likelihood import effective_share
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.variance import robust_size
from jbf.records.findings.finding import Finding

Weights = Sequence[Array]

ERROR = 1.9
"""Relative standard error of a robust standard deviation, times the root of the sample count.

The estimate is the median of absolute third differences. The value is 1.17 for independent
differences (Rousseeuw & Croux 1993) and larger here, since neighbouring differences share readings.
It is a property of the estimator.
"""
START_FREEDOM = 5.0
"""Degrees of freedom of Student's t distribution at the start of its fit."""


def variance_by_force(model: Model) -> Proposal | None:
    """Propose a noise variance that increases with the square of the force."""
    return _weighted(model, "noise_with_force", force_weights, 1)


def variance_by_run(model: Model) -> Proposal | None:
    """Propose a noise variance that differs between runs."""
    runs = len(model.campaign.prepared)
    return _weighted(model, "noise_by_run", run_weights, max(runs - 1, 1))


def _weighted(
    model: Model,
    kind: str,
    weights: Callable[[Problem, Solution, Policy], tuple[Weights, Finding] | None],
    parameters: int,
) -> Proposal | None:
    """Propose weights from a variance function; None if the campaign already has them."""
    problem, solution, campaign = model.problem, model.solution, model.campaign
    if any(f.kind == kind for f in campaign.more_findings):
        return None
    estimate = weights(problem, solution, model.policy)
    if estimate is None:
        return None
    levels, finding = estimate
    again, after = _reweighted(model, levels, finding, of_level=True)
    before = campaign.samples.within(solution.samples.counted)
    # The likelihood of a sample has the factor 1 / (standard deviation).
    fitted = [w > 0.0 for w in after.samples.weight]
    logs = sum(float(np.sum(np.log(w[at]))) for w, at in zip(levels, fitted, strict=True))
    gain = before.cost(solution.residuals, solution.noise) - after.cost + 2.0 * logs
    price = price_of_term(model.policy, parameters)
    return Proposal(again, problem, after, effective_share(after) * gain, price)


def _reweighted(
    model: Model, factors: Weights, finding: Finding, *, of_level: bool
) -> tuple[Campaign, Solution]:
    """Campaign with factors for the noise level or the heavy tails, and the model refitted."""
    campaign, solution = model.campaign, model.solution
    samples = campaign.samples.with_factors(factors, of_level=of_level)
    after = refitted(model.problem, solution, samples.within(solution.samples.counted))
    return replace(campaign, samples=samples).with_findings([finding]), after


def heavy_tails(model: Model) -> Proposal | None:
    """Propose Huber weights if Student's t distribution is more likely than the normal one.

    Returns None if the heavy tails are due to the quantisation steps of a converter.
    """
    solution, campaign, policy = model.solution, model.campaign, model.policy
    if any(f.kind == "heavy_tails" for f in campaign.more_findings):
        return None
    if campaign.step_n >= policy.noise.max_step_ratio * solution.rms:
        return None
    estimate = robust_weights(solution, policy)
    if estimate is None:
        return None
    weights, finding, gain = estimate
    again, after = _reweighted(model, weights, finding, of_level=False)
    gain *= effective_share(solution)
    return Proposal(again, model.problem, after, gain, price_of_term(policy))


def force_weights(
    problem: Problem, solution: Solution, policy: Policy
) -> tuple[Weights, Finding] | None:
    """Sample weights from a linear fit of the noise variance to the square of the force.

    Returns None if the variance does not depend on the force.
    """
    samples = solution.samples
    # Use the white part only: the lack of fit of a model is autocorrelated.
    e = _white_parts(solution)
    force = [np.abs(f) for f in problem.predict(solution.values)]
    flat_e, flat_f = samples.flat(e), samples.flat(force)
    bins = policy.noise.force_bins
    if robust_size(flat_e) <= 0.0 or len(flat_e) < policy.noise.min_samples * bins:
        return None
    edges = np.quantile(flat_f, np.linspace(0.0, 1.0, bins + 1))
    middle = 0.5 * (edges[1:] + edges[:-1])
    which = np.clip(np.searchsorted(edges, flat_f) - 1, 0, bins - 1)
    counts = np.bincount(which, minlength=bins)
    # Bins may be empty if many forces are equal, as at rest.
    full = np.flatnonzero(counts)
    counts, middle = counts[full], middle[full]
    sizes = np.array([robust_size(flat_e[which == k]) for k in full])
    if not _uneven(sizes, counts, policy):
        return None
    slope, level = np.polyfit(middle**2, sizes**2, 1)
    largest = level + slope * middle[-1] ** 2
    if slope <= 0.0 or largest <= policy.noise.min_ratio**2 * sizes.min() ** 2:
        return None
    least = max(level, 0.25 * sizes.min() ** 2)
    sd = [np.sqrt(least + slope * f**2) for f in force]
    low = min(float(s.min()) for s in sd)
    share = float(np.sqrt(slope))
    words = f"the noise grows with the force: {100.0 * share:.2g} % of it"
    return [low / s for s in sd], _finding("noise_with_force", samples, share, words)


def run_weights(
    problem: Problem, solution: Solution, policy: Policy
) -> tuple[Weights, Finding] | None:
    """Sample weights by run, from its noise level; None if the noise does not differ between runs.

    Both the white part and the innovations must differ, since a filtered channel has no white
    noise, and the innovations of a wrong model are larger than the noise.
    """
    samples = solution.samples
    e = _white_parts(solution)
    innovations = samples.innovations(solution.residuals, solution.noise)
    white, total = (
        np.array([robust_size(x[c]) for x, c in zip(v, samples.counted, strict=True)])
        for v in (e, innovations)
    )
    # Equal readings of a coarse converter have zero differences: use the rounding error.
    rounding = np.array([p.converter_step_n for p in problem.campaign.prepared]) / np.sqrt(12.0)
    white, total = np.maximum(white, rounding), np.maximum(total, rounding)
    counts = np.array([int(c.sum()) for c in samples.counted])
    valid = (counts > policy.noise.min_samples) & (white > 0.0) & (total > 0.0)
    if not valid.any() or not all(_uneven(x[valid], counts[valid], policy) for x in (white, total)):
        return None
    by_run = np.ones(len(valid))
    by_run[valid] = np.maximum(*(x[valid].min() / x[valid] for x in (white, total)))
    ratio = float(by_run.max() / by_run.min())
    words = f"the noise level differs between runs by a factor of up to {ratio:.2g}"
    weights = [np.full(len(x), w) for x, w in zip(e, by_run.tolist(), strict=True)]
    return weights, _finding("noise_by_run", samples, ratio, words)


def robust_weights(solution: Solution, policy: Policy) -> tuple[Weights, Finding, float] | None:
    """Huber weights against heavy tails, a finding, and the gain of Student's t distribution.

    The gain is relative to the normal distribution, in twice the log likelihood. Returns None if
    the tails are not heavy.
    """
    samples = solution.samples
    e = samples.innovations(solution.residuals, solution.noise)
    flat = samples.flat(e)
    sigma = robust_size(flat)
    if sigma <= 0.0 or not len(flat):
        return None
    beyond = float(np.mean(np.abs(flat) > policy.noise.tail_sigma * sigma))
    usual = 2.0 * float(special.ndtr(-policy.noise.tail_sigma))
    if beyond < max(policy.noise.min_tail_ratio * usual, policy.noise.min_tails / len(flat)):
        return None
    # The square of a weight on the residual is Huber's weight on its square.
    limit = policy.noise.huber_sigma * sigma
    weights = [np.sqrt(np.minimum(1.0, limit / np.maximum(np.abs(x), 1e-300))) for x in e]
    words = f"{100.0 * beyond:.2g} % of the noise exceeds 4 standard deviations"
    finding = _finding("heavy_tails", samples, beyond, words)
    return weights, finding, _student_gain(flat, sigma)


def _finding(kind: str, samples: Samples, size: float, words: str) -> Finding:
    """Finding on the noise of all runs; `size` is a ratio or a share."""
    runs = ", ".join(samples.runs)
    return Finding(kind, "friction_n", runs, size, "1", "weighted", words)


def _student_gain(innovations: Array, sigma: float) -> float:
    """Log-likelihood gain (doubled) of Student's t over the normal distribution of innovations.

    Both have their maximum-likelihood parameters (Lange, Little & Taylor 1989).
    """

    def minus_twice(x: Array) -> float:
        """Minus twice the log likelihood of Student's t distribution with log parameters `x`."""
        freedom, scale = np.exp(x)
        constant = special.betaln(0.5, 0.5 * freedom) + 0.5 * np.log(freedom) + x[1]
        tails = np.log1p((innovations / scale) ** 2 / freedom)
        return float(2.0 * len(innovations) * constant + (freedom + 1.0) * np.sum(tails))

    start = np.log([START_FREEDOM, sigma])
    fit = optimize.minimize(minus_twice, start, method="Nelder-Mead", options={"fatol": 0.1})
    normal = len(innovations) * (1.0 + np.log(2.0 * np.pi * np.mean(innovations**2)))
    return float(normal - fit.fun)


def _white_parts(solution: Solution) -> list[Array]:
    """White part of each residual, from third differences, relative to the noise level."""
    levels = solution.samples.level or [np.ones(len(r)) for r in solution.residuals]
    white_parts = []
    for residual, level in zip(solution.residuals, levels, strict=True):
        third = np.diff(residual, 3) / np.sqrt(20.0)
        white_parts.append(np.pad(third, (1, len(residual) - len(third) - 1), mode="edge") * level)
    return white_parts


def _uneven(sizes: Array, counts: npt.NDArray[np.int_], policy: Policy) -> bool:
    """Whether noise standard deviations `sizes` differ significantly and by a relevant ratio."""
    if float(sizes.min()) <= 0.0 or sizes.max() <= policy.noise.min_ratio * sizes.min():
        return False
    error = ERROR / np.sqrt(counts)
    logs = np.log(sizes)
    middle = float(np.sum(logs / error**2) / np.sum(1.0 / error**2))
    square = float(np.sum(((logs - middle) / error) ** 2))
    return bool(special.chdtrc(len(sizes) - 1, square) < policy.terms.chance)
