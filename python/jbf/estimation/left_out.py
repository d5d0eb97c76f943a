"""The left-out error: prediction of runs that had no part in the fit, each left out once; of many
runs several at a time."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.campaign import Campaign
from jbf.estimation.held_out_ranges import alternate_parts
from jbf.estimation.problem import Problem
from jbf.estimation.rows import triangular
from jbf.estimation.samples import Samples
from jbf.estimation.search import search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

EVALUATIONS = 12
"""A refit that starts one Gauss-Newton step from the whole campaign's solution is close."""
SHORT = 3.0
"""Standard deviations a parameter by which a step is short: noise makes the rest of the runs ask
for as much. From the end of a longer one a search goes on."""
STRAIGHT = 0.05
"""Share of a step's change of the prediction by which that may be off the derivatives' for the step
to be the whole way."""
NOTHING = 0.01
"""Share of the residual that no prediction needs to be closer than."""
MOST_FITS = 12
"""Fits without a run; of more runs groups are left out: so many folds of a cross-validation."""
INSENSITIVE = 1e-4
"""Runs say nothing of a parameter where they hold less than this share of what is known of it."""


@dataclass(frozen=True)
class LeftOut:
    """Samples that had no part in a fit, and what it leaves of their runs.

    Attributes
    ----------
    runs
        Which runs.
    left
        Which of their samples had no part, one mask a run.
    told
        Of which parameters the fitted samples tell; the others were held, shape (k,).
    residuals
        Record minus prediction, N, of the whole of each run.
    """

    runs: tuple[int, ...]
    left: tuple[Mask, ...]
    told: Mask
    residuals: tuple[Array, ...]

    def without(self, runs: Collection[int]) -> LeftOut:
        """The same of the other runs."""
        kept = [k for k, i in enumerate(self.runs) if i not in runs]
        return LeftOut(
            tuple(self.runs[k] for k in kept),
            tuple(self.left[k] for k in kept),
            self.told,
            tuple(self.residuals[k] for k in kept),
        )


def left_out_rms(problem: Problem, solution: Solution, *, apart: bool = False) -> float:
    """RMS of `left_out_by_run`, N."""
    left = np.concatenate(left_out_by_run(problem, solution, apart=apart))
    return float(np.sqrt(np.sum(left**2) / max(len(left), 1)))


def left_out_residuals(problem: Problem, solution: Solution) -> Array:
    """`left_out_by_run`, all runs in a row."""
    return np.concatenate(left_out_by_run(problem, solution))


def left_out_by_run(problem: Problem, solution: Solution, *, apart: bool = False) -> list[Array]:
    """`errors_by_run` of the runs left out of the fit (`left_out`)."""
    return list(errors_by_run(solution, left_out(problem, solution), apart=apart).values())


def errors_by_run(
    solution: Solution,
    parts: Sequence[LeftOut],
    *,
    apart: bool = False,
    counted: Sequence[Mask] | None = None,
) -> dict[int, Array]:
    """Errors at the samples that count, N, by run.

    Parameters
    ----------
    counted
        Those that count where models are compared that set different ones aside.
    apart
        Less what a run's own deviations from the others explain, where runs are known to have them:
        for models to be compared, since no model predicts those.
    """
    samples = solution.samples
    errors: dict[int, Array] = {}
    for part in parts:
        residuals: Sequence[Array] = part.residuals
        if apart:
            residuals = samples.only(part.runs).without_deviations(residuals, solution.noise)
        for i, left, residual in zip(part.runs, part.left, residuals, strict=True):
            own = errors.setdefault(i, np.zeros(len(residual)))
            own[left] = residual[left]
    counted = samples.counted if counted is None else counted
    return {i: errors[i][counted[i]] for i in sorted(errors)}


def left_out(problem: Problem, solution: Solution) -> list[LeftOut]:
    """Runs left out of the fit, one at a time or, of more than `MOST_FITS`, in so many groups.

    A parameter that the remaining runs say nothing of goes back to its null (or its starting
    value) and is held there: what only the left-out run could know must not leak into its
    prediction. With one run its halves, of alternate parts, take turns.
    """
    count = len(problem.campaign.prepared)
    if count == 1:
        return _halves(problem, solution)
    told = _Told.of(problem, solution)
    parts = []
    for group in _groups(problem.campaign):
        rest = [k for k in range(count) if k not in group]
        residuals = _predicted(problem, solution, told, group, rest)
        whole = tuple(np.ones(len(r), dtype=bool) for r in residuals)
        unknown = _unknown(told.known, told.known[rest].sum(axis=0))
        parts.append(LeftOut(tuple(group), whole, ~unknown, tuple(residuals)))
    return parts


def only_witnesses(problem: Problem, solution: Solution) -> frozenset[int]:
    """Runs without which the others say nothing of some parameter: no fit to those can predict
    what it does there, but a fit that has half of the run can."""
    count = len(problem.campaign.prepared)
    if count == 1:
        return frozenset()
    known = _known(solution)
    return frozenset(
        i
        for i in range(count)
        if _unknown(known, known[[k for k in range(count) if k != i]].sum(axis=0)).any()
    )


def halves_left_out(
    problem: Problem, solution: Solution, run: int, *, alternate: bool = False
) -> list[LeftOut]:
    """Two halves of one run, which take turns in having no part in a fit to the rest and to all
    other runs.

    Parameters
    ----------
    alternate
        Whether they are alternate parts (`alternate_parts`), which hold the same kinds of motion;
        else the first and the second half, which tell whether the run is the same throughout.
    """
    samples, known = solution.samples, _known(solution)
    every = [np.ones(len(c), dtype=bool) for c in samples.counted]
    others = known.sum(axis=0) - known[run]
    count = len(every[run])
    first = alternate_parts(count) if alternate else np.arange(count) < count // 2
    parts = []
    for half in (first, ~first):
        kept = samples.within([*every[:run], ~half, *every[run + 1 :]])
        own = np.sum(solution.jacobian[run][kept.counted[run]] ** 2, axis=0)
        unknown = _unknown(known, others + own)
        held = _held(problem, unknown)
        part = _of(problem, problem.campaign, held)
        values = _fitted(part, kept, _at(problem, solution, held), solution)
        residuals = tuple(problem.residuals(values, [run]))
        parts.append(LeftOut((run,), (half,), ~unknown, residuals))
    return parts


def _known(solution: Solution) -> Array:
    """Sums of squares of the derivatives at the samples that count, shape (runs, k)."""
    pairs = zip(solution.jacobian, solution.samples.counted, strict=True)
    return np.array([np.sum(jacobian[counted] ** 2, axis=0) for jacobian, counted in pairs])


def _unknown(known: Array, rest: Array) -> Mask:
    """Of which parameters that rest of what is known says nothing, shape (k,)."""
    unknown: Mask = rest < INSENSITIVE * known.sum(axis=0)
    return unknown


@dataclass(frozen=True)
class _Told:
    """What each run tells of the parameters, by the derivatives at a solution.

    Attributes
    ----------
    known
        Sums of squares of the derivatives, one (k,) a run.
    factors
        Innovations and derivatives in few rows, a pair a run.
    innovations
        How many there are, of each run.
    """

    known: Array
    factors: list[tuple[Array, Array]]
    innovations: list[int]

    @classmethod
    def of(cls, problem: Problem, solution: Solution) -> _Told:
        factors, innovations = [], []
        for i in range(len(problem.campaign.prepared)):
            jacobian, residual = solution.jacobian[i], solution.residuals[i]
            one = solution.samples.only([i])
            r, j = one.stacked([residual], [jacobian], solution.noise)
            factors.append(triangular(r, j))
            innovations.append(len(r))
        return cls(_known(solution), factors, innovations)

    def step(self, rest: list[int]) -> tuple[Array, float]:
        """The Gauss-Newton step to the rest of the runs, and its square in units of what their
        noise makes of steps."""
        r = np.concatenate([self.factors[i][0] for i in rest])
        j = np.concatenate([self.factors[i][1] for i in rest])
        step, *_ = np.linalg.lstsq(j, r, rcond=1e-12)
        ahead = j @ step
        count = max(sum(self.innovations[i] for i in rest), 1)
        square = float(ahead @ ahead) * count / max(float(r @ r), 1e-300)
        return np.asarray(step), square


def _predicted(
    problem: Problem, solution: Solution, told: _Told, group: list[int], rest: list[int]
) -> list[Array]:
    """Residuals, N, of runs that had no part in the fit to the rest."""
    held = _held(problem, _unknown(told.known, told.known[rest].sum(axis=0)))
    start = _at(problem, solution, held)
    step: Array | None = None
    if not held:
        way, square = told.step(rest)
        there = problem.encode(solution.values) + way
        step = problem.decode(there, solution.values)
        inside = np.allclose(problem.encode(step), there, rtol=0.0, atol=1e-9)
        # Of a likelihood with peak beside peak no step tells which one the rest would climb.
        smooth = solution.converged and not any(find_effect(e).peaks for e in solution.effects)
        if inside and smooth and square <= SHORT**2 * len(way):
            residuals = problem.residuals(step, group)
            if _straight(solution, way, group, residuals):
                return residuals
    part = _of(problem, problem.campaign.only(rest), held)
    kept = solution.samples.only(rest)
    if step is not None:
        # A law that misses the data badly is no place to extrapolate from.
        start = min((step, start), key=lambda v: part.square(v, kept))
    return problem.residuals(_fitted(part, kept, start, solution), group)


def _fitted(part: Problem, kept: Samples, start: Array, solution: Solution) -> Array:
    if not part.open:
        return start
    return search(part, kept, start, solution.noise, EVALUATIONS).values


def _straight(solution: Solution, way: Array, group: list[int], residuals: list[Array]) -> bool:
    """Whether predictions of runs go along a step as their derivatives say."""
    off, moved, size = 0.0, 0.0, 0.0
    for i, there in zip(group, residuals, strict=True):
        at = solution.samples.counted[i]
        here, change = solution.residuals[i][at], (solution.jacobian[i] @ way)[at]
        off += float(np.sum((here - change - there[at]) ** 2))
        moved += float(np.sum(change**2))
        size += float(np.sum(here**2))
    return off <= STRAIGHT**2 * moved + (STRAIGHT * NOTHING) ** 2 * size


def _groups(campaign: Campaign) -> list[list[int]]:
    """Runs that are left out together, each group with the same kinds of motion as the others.

    The runs are dealt out by direction, top speed and name: in whatever order they are given, the
    groups are the same.
    """
    speeds = [p.motion.velocity_m_s for p in campaign.prepared]
    order = sorted(
        range(len(speeds)),
        key=lambda i: (
            round(float(np.mean(np.sign(speeds[i])))),
            float(f"{np.max(np.abs(speeds[i]), initial=0.0):.2g}"),
            campaign.prepared[i].run.name,
        ),
    )
    return [sorted(order[k::MOST_FITS]) for k in range(min(MOST_FITS, len(order)))]


def _of(problem: Problem, campaign: Campaign, held: dict[str, float]) -> Problem:
    """The same problem on other runs, with more parameters held."""
    fixed = {**problem.fixed, **held}
    return Problem(campaign, problem.law, problem.clock, problem.effects, fixed)


def _held(problem: Problem, unknown: Mask) -> dict[str, float]:
    """The parameters of which nothing is known, at their null or where a search starts."""
    held = {}
    for i in np.asarray(problem.open)[unknown]:
        page = problem.parameters[problem.names[i]]
        null = page.null if page.null is not None and np.isfinite(page.null) else None
        held[problem.names[i]] = page.starts[0] if null is None else null
    return held


def _at(problem: Problem, solution: Solution, held: dict[str, float]) -> Array:
    """The whole solution, less what only runs that were left out know."""
    known = zip(problem.names, solution.values.tolist(), strict=True)
    return np.array([held.get(name, value) for name, value in known])


def _halves(problem: Problem, solution: Solution) -> list[LeftOut]:
    """Two halves of a single run, of alternate parts, each predicted by a fit to the other."""
    first = alternate_parts(len(solution.samples.counted[0]))
    parts = []
    for half in (~first, first):
        kept = solution.samples.within([~half])
        values = search(problem, kept, solution.values, solution.noise, EVALUATIONS).values
        told = np.ones(solution.free, dtype=bool)
        parts.append(LeftOut((0,), (half,), told, tuple(problem.residuals(values))))
    return parts
