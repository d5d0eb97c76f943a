"""Random effects between runs: offset, drift and gain of the sensor, temperature of the oil.

The deviation of a run from the campaign is a Gaussian random effect. Its standard deviation is
estimated from the runs (`estimation.random_effects`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from jbf.arrays import Array
from jbf.diagnosis.terms.proposal import (
    Model,
    Proposal,
    independent_fraction,
    price_of_term,
    refitted,
)
from jbf.estimation.campaign import Campaign
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import RandomEffects, spread_between
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.variance import robust_size
from jbf.records.findings.finding import Finding


def random_effect(model: Model) -> Proposal | None:
    """Propose random effects, the most significant first, until their joint evidence is positive.

    Usually the first one suffices. Next to a drift, however, the residual with an offset alone is
    correlated, and neither has positive evidence alone. If the evidence is not positive, the
    proposal with the largest one is returned; None if no random effect is significant.
    """
    problem, solution, campaign = model.problem, model.solution, model.campaign
    before = replace(solution, samples=campaign.samples.within(solution.samples.counted))
    after, findings, proposals = before, list[Finding](), list[Proposal]()
    while True:
        estimate = _most_significant(problem, after, after.samples, model.policy.terms.chance)
        if estimate is None:
            break
        between, finding = estimate
        findings.append(finding)
        after = refitted(problem, after, replace(before.samples, between=between))
        samples = replace(campaign.samples, between=between)
        again = replace(campaign, samples=samples).with_findings(findings)
        price = price_of_term(model.policy, len(findings))
        proposals.append(Proposal(again, problem, after, _gain(after, before), price))
        if proposals[-1].evidence > 0.0:
            return proposals[-1]
    return max(proposals, key=lambda proposal: proposal.evidence, default=None)


def without_random_effect(model: Model) -> Campaign | None:
    """Return the campaign without the random effect whose gain is smallest and not positive.

    Returns None if every random effect increases the marginal likelihood.
    """
    problem, solution, campaign = model.problem, model.solution, model.campaign
    between = campaign.samples.between
    if between is None:
        return None
    gains = {}
    for name in between.names:
        fewer = replace(solution.samples, between=between.without(name))
        gains[name] = _gain(solution, refitted(problem, solution, fewer))
    name = min(gains, key=lambda name: gains[name])
    if gains[name] >= 0.0:
        return None
    samples = replace(campaign.samples, between=between.without(name))
    text_before_value = FINDINGS[name][1].partition("{")[0]
    findings = tuple(f for f in campaign.more_findings if not f.words.startswith(text_before_value))
    return replace(campaign, samples=samples, more_findings=findings)


def _gain(richer: Solution, simpler: Solution) -> float:
    """Gain of the random effects in a model, in twice the log marginal likelihood."""
    penalty = richer.samples.log_determinant_between(richer.noise)
    penalty -= simpler.samples.log_determinant_between(simpler.noise)
    gain = simpler.samples.cost(simpler.residuals, simpler.noise) - richer.cost
    return independent_fraction(richer, simpler) * gain - penalty


def _most_significant(
    problem: Problem, solution: Solution, samples: Samples, chance: float
) -> tuple[RandomEffects, Finding] | None:
    """Present random effects plus the most significant additional one, with its finding, or None.

    Random effects resemble each other, so that the significance of the next one is tested with the
    present ones in the model.
    """
    if len(samples.runs) < samples.settings.variance.min_runs:
        return None
    present = samples.between
    r, _ = samples.stacked(solution.residuals, solution.jacobian, solution.noise)
    sigma = robust_size(r)
    best: tuple[float, str, str, float, list[Array]] | None = None
    for name, unit, column in _columns(problem, solution):
        if present is not None and name in present.names:
            continue
        estimate = _spread(samples, solution, column, sigma)
        if estimate is None or estimate[1] > chance or estimate[0] <= 0.0:
            continue
        if best is None or estimate[2] > best[0]:
            best = (estimate[2], name, unit, estimate[0], column)
    if best is None:
        return None
    _, name, unit, sd, column = best
    # Exclude the between-run deviations from the noise.
    sigma = robust_size(_within_runs(samples, solution, column))
    kind, text = FINDINGS[name]
    words = text.format(sd=sd, percent=100.0 * sd, unit=unit)
    runs = ", ".join(samples.runs)
    finding = Finding(kind, "friction_n", runs, sd, unit, "a spread of the runs", words)
    directions = [c[:, None] * sd for c in column]
    if present is None:
        return RandomEffects((name,), tuple(directions), sigma), finding
    both = tuple(np.hstack(pair) for pair in zip(present.directions, directions, strict=True))
    return RandomEffects((*present.names, name), both, sigma), finding


def _columns(problem: Problem, solution: Solution) -> list[tuple[str, str, list[Array]]]:
    """Name, unit and derivative of the force of each possible random effect, one array per run."""
    quantities = problem.campaign.rig.quantities
    columns = [("zero", quantities.force, [np.ones(len(r)) for r in solution.residuals])]
    times = [p.run.time_s for p in problem.campaign.prepared]
    columns.append(("drift", quantities.unit("N/s"), [t - 0.5 * (t[0] + t[-1]) for t in times]))
    by_name = {problem.names[i]: k for k, i in enumerate(problem.open)}
    for name in ("U_tr_m_s", "gamma"):
        # Higher oil temperature: a higher transition speed and less viscous friction.
        if name in by_name:
            columns.append((name, "1", [j[:, by_name[name]] for j in solution.jacobian]))
    columns.append(("gain", "1", problem.predict(solution.values)))
    return columns


def _by_run(
    samples: Samples, solution: Solution, column: list[Array]
) -> Iterator[tuple[Array, Array]]:
    """Innovations of each run, N, and the whitened derivative with respect to its deviation."""
    columns = [c[:, None] for c in column]
    for i in range(len(samples.runs)):
        r, n = samples.stacked(solution.residuals, columns, solution.noise, [i])
        yield r, n[:, 0]


def _within_runs(samples: Samples, solution: Solution, column: list[Array]) -> Array:
    """Innovations of all runs without the estimated deviation of each run, N."""
    innovations = []
    for r, n in _by_run(samples, solution, column):
        size = float(n @ n)
        innovations.append(r - n * (float(n @ r) / size if size > 0.0 else 0.0))
    return np.concatenate(innovations)


def _spread(
    samples: Samples, solution: Solution, column: list[Array], sigma: float
) -> tuple[float, float, float] | None:
    """Estimate the between-run standard deviation of one random effect (`spread_between`).

    Returns the standard deviation, its significance (p-value), and the ratio of Cochran's statistic
    to its degrees of freedom; None if it cannot be estimated.
    """
    if sigma**2 == 0.0:
        return None
    estimates, precisions = [], []
    for r, n in _by_run(samples, solution, column):
        size = float(n @ n) / sigma**2
        if size <= 0.0:
            continue
        estimates.append(float(n @ r) / sigma**2 / size)
        precisions.append(size)
    if len(estimates) < samples.settings.variance.min_runs:
        return None
    return spread_between(np.array(estimates), np.array(precisions))


FINDINGS = {
    "zero": ("level_by_run", "offset differs between runs by {sd:.2g} {unit} (1 s.d.)"),
    "drift": (
        "drift_by_run",
        "offset drifts differently in each run, by {sd:.2g} {unit} (1 s.d.)",
    ),
    "gain": ("gain_by_run", "gain differs between runs by {percent:.2g} % (1 s.d.)"),
    "U_tr_m_s": (
        "oil_by_run",
        "transition speed differs between runs by {percent:.2g} % (1 s.d.); check the oil "
        "temperature",
    ),
    "gamma": (
        "oil_by_run",
        "viscous friction differs between runs by {percent:.2g} % (1 s.d.); check the oil "
        "temperature",
    ),
}
"""Kind and text of the finding on each random effect.

`without_random_effect` finds it by the text before the first value.
"""
