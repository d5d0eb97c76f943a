"""A second look at the samples, once a first round of selection has said what the model is.

Where the noise grows with the force or differs by run, where its tails are heavy, and where runs
deviate from one another in their zero or their oil, the first likelihood was not the data's. What
the residuals of the first answer tell of that goes into the samples: weights, and deviations of the
runs with a spread (`estimation.between_runs`). Then selection begins anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.policy import Policy
from jbf.diagnosis.uneven_noise import noise_sizes, robust_size, robust_weights
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.campaign import Campaign
from jbf.estimation.minimum import search
from jbf.estimation.problem import Problem
from jbf.estimation.random_effect import spread_between
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]

EVALUATIONS = 8
"""Steps of a fit that shows where weights lead."""
MOST_FORGIVEN = 1.03
"""Times the RMS, all samples alike, that weights may cost."""


@dataclass(frozen=True, eq=False)
class SecondLook:
    """What the residuals of a first answer tell of the noise and of the runs."""

    campaign: Campaign
    found: bool


def second_look(problem: Problem, solution: Solution, policy: Policy) -> SecondLook:
    """The campaign as the residuals of a solution ask for it.

    One deviation is found at a look, the clearest: what is missing yet may look like another.
    """
    campaign = problem.campaign
    known = {f.kind for f in campaign.more_findings}
    ones = [np.ones(len(r)) for r in solution.residuals]
    sizes, robust, found = ones, ones, []
    # Weights are given once.
    if not known & {"noise_with_force", "noise_by_run"}:
        shares, uneven = noise_sizes(problem, solution, policy)
        if uneven and _keeps(problem, solution, campaign.samples.weighed(shares, ones, None)):
            sizes, found = shares, uneven
    if "heavy_tails" not in known:
        shares, heavy = robust_weights(solution, sizes, policy.heavy_tails)
        if heavy and _keeps(problem, solution, campaign.samples.weighed(sizes, shares, None)):
            robust, found = shares, [*found, *heavy]
    both = [s * w for s, w in zip(sizes, robust, strict=True)]
    between, deviations = _between(problem, solution, both, policy.deviation_chance)
    samples = campaign.samples.weighed(sizes, robust, between)
    if deviations and not _keeps(problem, solution, samples):
        between, deviations = campaign.samples.between, []
        samples = campaign.samples.weighed(sizes, robust, between)
    findings = [*found, *deviations]
    if not findings:
        return SecondLook(campaign, False)
    again = replace(campaign, samples=samples).with_findings(findings)
    return SecondLook(again, True)


def _keeps(problem: Problem, solution: Solution, samples: Samples) -> bool:
    """Whether a fit on these samples still predicts as well as before where all count alike.

    Of noise alone it does, whatever the weights. Where a model is wrong its error passes for noise,
    and weights would give up what they call so.
    """
    moved = samples.within(solution.samples.counted)
    values, _, _ = search(problem, moved, solution.values, solution.noise, EVALUATIONS)
    before = solution.samples.rms(solution.residuals)
    return solution.samples.rms(problem.residuals(values)) <= MOST_FORGIVEN * before


def _between(
    problem: Problem, solution: Solution, shares: list[Array], chance: float
) -> tuple[BetweenRuns | None, list[Finding]]:
    """The deviations of the runs known so far, and the clearest of those beyond chance besides."""
    known = problem.campaign.samples.between
    ones = [np.ones(len(s)) for s in shares]
    samples = solution.samples.weighed(shares, ones, known)
    if len(samples.runs) < 3:
        return known, []
    r, _ = samples.stacked(solution.residuals, solution.jacobian, solution.noise)
    sigma = robust_size(r)
    best: tuple[float, str, str, float, list[Array]] | None = None
    for name, unit, column in _columns(problem, solution):
        if known is not None and name in known.names:
            continue
        found = _spread(samples, solution, column, sigma)
        if found is None or found[1] > chance or found[0] <= 0.0:
            continue
        if best is None or found[2] > best[0]:
            best = (found[2], name, unit, found[0], column)
    if best is None:
        return known, []
    _, name, unit, sd, column = best
    kind, words = _words(name, sd)
    runs = ", ".join(samples.runs)
    finding = Finding(kind, "friction_n", runs, sd, unit, "a spread of the runs", words)
    own = [c[:, None] * sd for c in column]
    if known is None:
        return BetweenRuns((name,), tuple(own), sigma), [finding]
    both = tuple(np.hstack(pair) for pair in zip(known.directions, own, strict=True))
    return BetweenRuns((*known.names, name), both, sigma), [finding]


def _columns(problem: Problem, solution: Solution) -> list[tuple[str, str, list[Array]]]:
    """What a deviation adds to the friction: name, unit, one column a run."""
    found = [("zero", "N", [np.ones(len(r)) for r in solution.residuals])]
    by_name = {problem.names[i]: k for k, i in enumerate(problem.open)}
    for name in ("U_tr_m_s", "gamma"):
        # A warmer oil: a film that carries later, and less drag.
        if name in by_name:
            found.append((name, "1", [j[:, by_name[name]] for j in solution.jacobian]))
    found.append(("gain", "1", problem.predict(solution.values)))
    return found


def _spread(
    samples: Samples, solution: Solution, column: list[Array], sigma: float
) -> tuple[float, float, float] | None:
    """Standard deviation between runs of a deviation along a column, the probability of so much by
    chance, and how many times as much as chance it is (DerSimonian & Laird 1986)."""
    estimates, precisions = [], []
    columns = [c[:, None] for c in column]
    for i in range(len(samples.runs)):
        r, n = samples.stacked(solution.residuals, columns, solution.noise, [i])
        # What the parameters can do in all runs together is not taken from one run's deviation.
        size = float(n[:, 0] @ n[:, 0]) / sigma**2
        if size <= 0.0:
            continue
        estimates.append(float(n[:, 0] @ r) / sigma**2 / size)
        precisions.append(size)
    if len(estimates) < 3:
        return None
    return spread_between(np.array(estimates), np.array(precisions))


def _words(name: str, sd: float) -> tuple[str, str]:
    if name == "zero":
        return "level_by_run", f"the zero differs by run by {sd:.2g} N (1 s.d.)"
    if name == "gain":
        return "gain_by_run", f"the gain differs by run by {100.0 * sd:.2g} % (1 s.d.)"
    what = "transition speed" if name == "U_tr_m_s" else "viscous friction"
    words = f"the {what} differs by run by {100.0 * sd:.2g} % (1 s.d.): the oil's warmth?"
    return "oil_by_run", words
