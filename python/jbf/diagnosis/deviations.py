"""Deviations of the runs as a candidate beside the effects: the cell's zero and gain, the oil's
warmth.

What differs from run to run and has no cause in the record is a random effect with a spread
(`estimation.between_runs`). It asks for evidence like any effect, in the same units, and an effect
that the data ask for more goes first: a load that differs by run looks like a gain that does.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from jbf.diagnosis.policy import Policy
from jbf.estimation.between_runs import BetweenRuns
from jbf.estimation.campaign import Campaign
from jbf.estimation.left_out import left_out_by_run
from jbf.estimation.likelihood import effective_share
from jbf.estimation.long_run import sure_inflation
from jbf.estimation.noise_at import noise_at
from jbf.estimation.problem import Problem
from jbf.estimation.random_effect import spread_between
from jbf.estimation.robust import robust_size
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.records.findings.finding import Finding

Array = npt.NDArray[np.float64]

EVALUATIONS = 8
"""Steps of a fit that shows where deviations lead."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """What differs from run to run.

    Attributes
    ----------
    samples
        Those of the campaign, correlated within each run as the deviation makes them.
    finding
        What it is.
    gain
        In twice the log likelihood, less the volume of what the runs could have deviated by.
    """

    samples: Samples
    finding: Finding
    gain: float


def deviation(
    problem: Problem,
    solution: Solution,
    samples: Samples,
    policy: Policy,
    least_gain: float = 0.0,
) -> Deviation | None:
    """The clearest deviation of the runs that is not known yet; None where there is none beyond
    chance, or where a fit that allows for it predicts runs left out worse.

    One at a time: what is missing yet may look like another.

    Parameters
    ----------
    samples
        Those of the campaign, weighed as is known by now.
    least_gain
        What it must gain.
    """
    counted = samples.within(solution.samples.counted)
    found = _clearest(problem, solution, counted, policy.deviation_chance)
    if found is None:
        return None
    between, finding = found
    allowed = replace(counted, between=between)
    values = search(problem, allowed, solution.values, solution.noise, EVALUATIONS).values
    # What the runs deviated by had passed for colour.
    after = problem.solution(values, allowed, noise_at(problem, allowed, values))
    gain = counted.cost(solution.residuals, solution.noise) - after.cost
    volume = _volume(allowed, after) - _volume(counted, solution)
    gain = _share(after, replace(solution, samples=counted)) * gain - volume
    if gain <= least_gain:
        return None
    before = replace(solution, samples=counted)
    if _predicts_worse(problem, after, before, policy.no_worse):
        return None
    return Deviation(replace(samples, between=between), finding, gain)


def _share(after: Solution, before: Solution) -> float:
    """How much the gain counts, by the same measure as an effect's (`share_of_gain`)."""
    left, was = (s.samples.weighted_innovations(s.residuals, after.noise) for s in (after, before))
    ways = [b - e for b, e in zip(was, left, strict=True)]
    return min(effective_share(after), 1.0 / sure_inflation(ways, left, after.samples.steps_s))


def _predicts_worse(problem: Problem, after: Solution, before: Solution, most: float) -> bool:
    """Whether runs left out are predicted worse, by more than a ratio and the chance of which runs
    there are. Each run counts alike: where runs deviate, one that deviates most is no judge."""
    rms = [
        np.array([np.sqrt(np.mean(e**2)) for e in left_out_by_run(problem, s) if len(e)])
        for s in (after, before)
    ]
    ratio = np.log(np.maximum(rms[0], 1e-300) / np.maximum(rms[1], 1e-300))
    error = float(np.std(ratio, ddof=1)) / np.sqrt(len(ratio))
    return bool(np.mean(ratio) - error > np.log(most))


def allowing_for(campaign: Campaign, found: Deviation) -> Campaign:
    """The campaign with a deviation of its runs allowed for."""
    return replace(campaign, samples=found.samples).with_findings([found.finding])


def _volume(samples: Samples, solution: Solution) -> float:
    if samples.between is None:
        return 0.0
    return samples.between.log_determinant(samples.weight, samples.steps_s, solution.noise)


def _clearest(
    problem: Problem, solution: Solution, samples: Samples, chance: float
) -> tuple[BetweenRuns, Finding] | None:
    """All known deviations of the runs with the clearest of the others."""
    if len(samples.runs) < 3:
        return None
    known = samples.between
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
        return None
    _, name, unit, sd, column = best
    # By how much runs differ is no noise: it is not what their deviations are measured by.
    sigma = robust_size(_within_runs(samples, solution, column))
    kind, words = _words(name, sd, unit)
    runs = ", ".join(samples.runs)
    finding = Finding(kind, "friction_n", runs, sd, unit, "a spread of the runs", words)
    own = [c[:, None] * sd for c in column]
    if known is None:
        return BetweenRuns((name,), tuple(own), sigma), finding
    both = tuple(np.hstack(pair) for pair in zip(known.directions, own, strict=True))
    return BetweenRuns((*known.names, name), both, sigma), finding


def _columns(problem: Problem, solution: Solution) -> list[tuple[str, str, list[Array]]]:
    """What a deviation adds to the friction: name, unit, one column a run."""
    said = problem.campaign.rig.quantities
    found = [("zero", said.force, [np.ones(len(r)) for r in solution.residuals])]
    times = [p.run.time_s for p in problem.campaign.prepared]
    found.append(("drift", said.unit("N/s"), [t - 0.5 * (t[0] + t[-1]) for t in times]))
    by_name = {problem.names[i]: k for k, i in enumerate(problem.open)}
    for name in ("U_tr_m_s", "gamma"):
        # A warmer oil: a film that carries later, and less drag.
        if name in by_name:
            found.append((name, "1", [j[:, by_name[name]] for j in solution.jacobian]))
    found.append(("gain", "1", problem.predict(solution.values)))
    return found


def _within_runs(samples: Samples, solution: Solution, column: list[Array]) -> Array:
    """Innovations of all runs less what each says of its own deviation along a column, N."""
    left = []
    columns = [c[:, None] for c in column]
    for i in range(len(samples.runs)):
        r, n = samples.stacked(solution.residuals, columns, solution.noise, [i])
        size = float(n[:, 0] @ n[:, 0])
        left.append(r - n[:, 0] * (float(n[:, 0] @ r) / size if size > 0.0 else 0.0))
    return np.concatenate(left)


def _spread(
    samples: Samples, solution: Solution, column: list[Array], sigma: float
) -> tuple[float, float, float] | None:
    """Standard deviation between runs of a deviation along a column, the probability of so much by
    chance, and how many times as much as chance it is (DerSimonian & Laird 1986)."""
    if sigma**2 == 0.0:
        # A model that leaves nothing leaves no run anything to deviate by.
        return None
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


def _words(name: str, sd: float, unit: str) -> tuple[str, str]:
    if name == "zero":
        return "level_by_run", f"the zero differs by run by {sd:.2g} {unit} (1 s.d.)"
    if name == "drift":
        return "drift_by_run", f"the zero drifts, by another {sd:.2g} {unit} (1 s.d.) in each run"
    if name == "gain":
        return "gain_by_run", f"the gain differs by run by {100.0 * sd:.2g} % (1 s.d.)"
    what = "transition speed" if name == "U_tr_m_s" else "viscous friction"
    words = f"the {what} differs by run by {100.0 * sd:.2g} % (1 s.d.): the oil's warmth?"
    return "oil_by_run", words
