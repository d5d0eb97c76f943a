"""Tests of constancy: the same parameters in all runs, and the same friction level in all strokes.

The parameters of a correct model are equal in all runs. With a confounder, they differ between
runs. The test for runs is the score test of parameter constancy (Nyblom 1989, with runs as groups).
The statistic is the sum of the gains of one Gauss-Newton step for each run from the fit to all
runs. It has a chi-square distribution. The degrees of freedom are the number of run-specific
parameters less the number of shared parameters. Scores are divided by the long-run standard
deviation of their run. The test requires no additional fit.

If a surface wears, sheds debris or is relubricated, the friction level differs between strokes,
which no parameter of a law describes. The test for strokes is an analysis of variance. The variance
between the strokes of a run is computed from the ratio of recorded and predicted friction, and the
variance within strokes from the difference between their two halves. For a correct model, and for a
wrong model with equal errors in all strokes, both estimate the same variance for any correlation
time of the noise. Their ratio has Fisher's F distribution. The predicted friction does not include
inertia, weight and other forces that do not depend on the sliding surfaces.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from jbf.arrays import Array, Mask
from jbf.comparison.parts import NO_FRICTION
from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.estimation.held_out_comparison import Strokes, stroke_of
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.variance import score_square
from jbf.models.catalogue import CARRIER, find_effect, in_chain_order, parameters_of
from jbf.models.chain import chain
from jbf.models.parameter_units import unit_of

OIL = {"U_tr_m_s", "gamma"}
"""Parameters that both vary with the oil temperature: if one differs, both are excluded."""
MOST_REPORTED = float(np.log(20.0))
"""Largest change of a parameter's logarithm that is reported as a number.

One Gauss-Newton step is not accurate beyond it. It concerns the text only.
"""
NAMED = 3
"""Number of runs listed in the description. It concerns the text only."""


@dataclass(frozen=True)
class Disagreement:
    """Test statistic for parameters that differ between runs.

    Attributes
    ----------
    gain
        Gain of run-specific parameters, in twice the log likelihood.
    degrees
        Expected gain by chance (degrees of freedom); zero for a single run.
    by_run
        Gain of each run divided by its degrees of freedom, largest first.
    """

    gain: float
    degrees: int
    by_run: dict[str, float]

    def beyond_chance(self, policy: Policy = DEFAULT) -> bool:
        """Whether the hypothesis of equal parameters in all runs is rejected."""
        if self.degrees == 0 or self.gain <= policy.constancy.min_ratio * self.degrees:
            return False
        return bool(special.chdtrc(self.degrees, self.gain) < policy.constancy.chance)


def disagreement(
    problem: Problem,
    solution: Solution,
    effect: str | None = None,
    policy: Policy = DEFAULT,
) -> Disagreement:
    """Compute the likelihood gain of run-specific parameters over common parameters.

    If an `effect` is given, its parameters are tested, and the part of each run that the other
    parameters could explain is projected out. By default all parameters are tested except those of
    effects with many peaks.
    """
    # Samples next to a jump with a fitted time contain the error of this time; they are excluded.
    samples = solution.samples.counted_only()
    aside = _of_many_peaks(problem) if effect is None else ~_of(problem, {effect})
    if samples.between is not None:
        # Parameters with a known variance between runs are not tested.
        varying = set(samples.between.names)
        if varying & OIL:
            varying |= OIL
        aside = aside | np.array([problem.names[i] in varying for i in problem.open])
    residuals, jacobian, noise = solution.residuals, solution.jacobian, solution.noise
    least = policy.constancy.min_sensitivity
    parts = [
        _set_aside(*samples.stacked(residuals, jacobian, noise, [i]), aside, least)
        for i in range(len(residuals))
    ]
    size = np.sqrt(np.sum([np.sum(j**2, axis=0) for _, j in parts], axis=0))
    scale = np.where(size > 0.0, size, 1.0)
    gain, degrees, by_run = 0.0, 0, {}
    together: list[tuple[Array, Array]] = []
    for (r, j), name, step_s in zip(parts, samples.runs, samples.steps_s, strict=True):
        directions = _directions(j / scale, least)
        count = directions.shape[1]
        if len(r) <= count:
            continue
        sigma = max(float(np.sqrt(np.mean(r**2))), 1e-150)
        run_gain = score_square(directions, r / sigma, step_s, samples.settings.variance)
        gain += run_gain
        degrees += count
        by_run[name] = run_gain / max(count, 1)
        together.append((r / sigma, j / scale / sigma))
    ranked = dict(sorted(by_run.items(), key=lambda item: -item[1]))
    if len(together) < 2:
        return Disagreement(0.0, 0, ranked)
    # A gain of common parameters is not a disagreement. It is nonzero if an estimate is at a bound,
    # or if the noise model differs from that of the fit, because the score is then not zero.
    r, j = (np.concatenate(a) for a in zip(*together, strict=True))
    common = float(np.sum((_directions(j, least).T @ r) ** 2))
    shared = int(np.sum(size > 0.0))
    return Disagreement(max(gain - common, 0.0), max(degrees - shared, 1), ranked)


def _of(problem: Problem, effects: Collection[str]) -> Mask:
    """Mask of the search variables that are parameters of the given effects."""
    return np.array([problem.names[i].split(".")[0] in effects for i in problem.open], dtype=bool)


def _of_many_peaks(problem: Problem) -> Mask:
    """Mask of the search variables of effects whose likelihood has many local maxima."""
    return _of(problem, {name for name in problem.effects if find_effect(name).peaks})


def _directions(j: Array, least: float) -> Array:
    """Orthonormal basis of the column space of a Jacobian, without weak directions.

    Directions are weak if their singular value is at most `least` times the largest one.
    """
    directions, size, _ = np.linalg.svd(j, full_matrices=False)
    effective: Array = directions[:, size > least * max(float(size.max(initial=0.0)), 1e-300)]
    return effective


def _set_aside(r: Array, j: Array, aside: Mask, least: float) -> tuple[Array, Array]:
    """Project the columns in `aside` out of residuals `r` and the other columns of a Jacobian `j`.

    The errors of the motion may lead to a different maximum of the likelihood in each run if an
    effect has many maxima.
    """
    if not aside.any():
        return r, j
    span = _directions(j[:, aside], least)
    rest = j[:, ~aside]
    return r - span @ (span.T @ r), rest - span @ (span.T @ rest)


def find_disagreement(problem: Problem, solution: Solution, policy: Policy) -> list[Remainder]:
    """Test whether parameters differ between runs; empty if they do not differ significantly."""
    test = disagreement(problem, solution, policy=policy)
    share = min((test.gain - test.degrees) / solution.samples.count, 1.0)
    if share < policy.patterns.min_share or not test.beyond_chance(policy):
        return []
    first, *others = list(test.by_run)[:NAMED]
    others = [name for name in others if test.by_run[name] > policy.constancy.min_ratio]
    step = run_specific_step(problem, solution, first)
    where = (
        f"parameters differ between runs: run {first} fits best with {step} "
        f"(chi-square {test.by_run[first]:.0f} times its expectation); check its "
        "load, zero and temperature"
    )
    if others:
        where += f" (next: {', '.join(others)})"
    return [Remainder("parameters", where, share)]


def run_specific_step(problem: Problem, solution: Solution, run: str) -> str:
    """Describe the run-specific parameter with the largest gain for one run.

    The reported difference is one Gauss-Newton step in this parameter alone.
    """
    samples = solution.samples.counted_only()
    i = samples.runs.index(run)
    r, j = samples.stacked(solution.residuals, solution.jacobian, solution.noise, [i])
    size = np.linalg.norm(j, axis=0)
    size = np.where((size > 0.0) & ~_of_many_peaks(problem), size, np.inf)
    gain = np.abs(j.T @ r) / size
    best = int(np.argmax(gain))
    step = float(j[:, best] @ r) / float(size[best]) ** 2
    place = problem.open[best]
    name, page = problem.names[place], problem.parameters[problem.names[place]]
    unit = unit_of(name, page, problem.law, problem.campaign.rig.quantities)
    more = "higher" if step > 0.0 else "lower"
    if problem.log[place]:
        part = float(np.expm1(np.clip(step, -MOST_REPORTED, MOST_REPORTED)))
        if abs(step) > MOST_REPORTED:
            # A single Gauss-Newton step is not accurate for a difference of this size.
            return f"{name} much {'larger' if step > 0.0 else 'smaller'}"
        return f"{name} {100.0 * abs(part):.3g} % {more}"
    return f"{name} {abs(step):.2g}{'' if unit == '-' else f' {unit}'} {more}"


def find_stroke_levels(problem: Problem, solution: Solution, policy: Policy) -> list[Remainder]:
    """Test whether the friction level differs between strokes; empty if it does not."""
    friction, counted = _friction(problem, solution), solution.samples.counted
    residuals = solution.samples.without_deviations(solution.residuals, solution.noise)
    between = within = friction_square = 0.0
    degrees = 0
    least = policy.strokes.min_samples
    for p, f, r, c in zip(problem.campaign.prepared, friction, residuals, counted, strict=True):
        halves = np.array(list(_halves(stroke_of(p), f, r, c, least))).reshape(-1, 2, 2)
        if len(halves) < policy.strokes.min_strokes:
            continue
        weight, product = halves[..., 0], halves[..., 1]
        level = product / weight
        stroke_weight = np.sum(weight, axis=1)
        deviation = np.sum(product, axis=1) / stroke_weight - np.sum(product) / np.sum(weight)
        between += float(np.sum(stroke_weight * deviation**2))
        difference = level[:, 1] - level[:, 0]
        difference_weight = np.prod(weight, axis=1) / stroke_weight
        difference -= np.average(difference, weights=difference_weight)
        within += float(np.sum(difference_weight * difference**2))
        degrees += len(halves) - 1
        friction_square += float(np.sum(weight))
    square = sum(float(r[c] @ r[c]) for r, c in zip(residuals, counted, strict=True))
    if not degrees or within <= 0.0 or square <= 0.0:
        return []
    ratio, share = between / within, (between - within) / square
    if share < policy.patterns.min_share:
        return []
    if special.fdtrc(degrees, degrees, ratio) > policy.constancy.chance:
        return []
    size = 100.0 * float(np.sqrt(share * square / friction_square))
    where = f"friction level differs between strokes by {size:.2g} % RMS (F = {ratio:.0f})"
    return [Remainder("stroke", where, min(share, 1.0))]


def _friction(problem: Problem, solution: Solution) -> list[Array]:
    """Predicted friction, N, one array per run: without sensor, inertia, weight and the like.

    The forces that are not friction are those of the same effects with another law, minus this law.
    """
    values = problem.values_by_name(solution.values)
    machine = [name for name in problem.effects if find_effect(name).stage != "instrument"]

    def force(law: str, effects: Sequence[str]) -> list[Array]:
        """Force of a law with effects, with the parameters of the solution."""
        pages = parameters_of(law, in_chain_order(effects))
        known = np.array([values.get(name, page.starts[0]) for name, page in pages.items()])
        core = chain(problem.campaign.rig, law, problem.clock, effects)
        return core.predict(known, problem.campaign.motions)

    friction = force(problem.law, machine)
    others = [name for name in machine if name in NO_FRICTION]
    if not others:
        return friction
    terms = zip(friction, force(CARRIER, others), force(CARRIER, ()), strict=True)
    return [f - with_others + law for f, with_others, law in terms]


def _halves(
    stroke: Strokes, friction: Array, residual: Array, counted: Mask, least: int
) -> Iterator[list[list[float]]]:
    """Sums of squares and products for the two halves of each stroke.

    Strokes with fewer than `least` samples per half are skipped. Each half has the sum of squares
    of the friction, N^2, and the sum of its products with the residual.
    """
    for k in range(int(np.max(stroke, initial=-1)) + 1):
        rows = np.flatnonzero((stroke == k) & counted)
        if len(rows) < 2 * least:
            continue
        halves = np.array_split(rows, 2)
        sums = [
            [float(friction[h] @ friction[h]), float(friction[h] @ residual[h])] for h in halves
        ]
        if min(sums[0][0], sums[1][0]) > 0.0:
            yield sums
