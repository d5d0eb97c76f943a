"""Held-out errors: prediction errors at samples that a fit did not use.

Each run is held out once; with many runs, several runs are held out at a time. A single run, and a
run beyond the range of all others (`extrapolated_runs`), is divided into parts, and alternate parts
are held out.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from jbf.arrays import Array, Mask
from jbf.estimation.approach import null_or_start
from jbf.estimation.campaign import Campaign
from jbf.estimation.least_squares import triangular
from jbf.estimation.levenberg_marquardt import bounded_step
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.search import NEAR_MINIMUM, search
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect

EVALUATIONS = 12
"""Evaluations of a refit by a search."""
SHORT = 3.0
"""Length of a step per parameter, in standard deviations, that is accepted without a search.

Noise alone causes steps of this length if runs are left out. A search continues from the end of a
longer step.
"""
STRAIGHT = 0.05
"""Deviation from linearity, as a fraction of a change, up to which one step suffices."""
STEP_DAMPING = 1e-10
"""Damping of the step: the kept samples may not determine a combination of parameters."""
NOTHING = 0.01
"""Fraction of the residual below which the error of a prediction is negligible."""


@dataclass(frozen=True)
class HeldOutPart:
    """Samples that were held out of a fit, and the residuals of their runs for this fit.

    Attributes
    ----------
    runs
        Indices of the runs.
    masks
        Mask of the held-out samples, one per run.
    identified
        Which parameters the fitted samples identify, shape (k,); the others were held fixed.
    residuals
        Record minus prediction of all samples of each run, N.
    """

    runs: tuple[int, ...]
    masks: tuple[Mask, ...]
    identified: Mask
    residuals: tuple[Array, ...]

    def without(self, runs: Collection[int]) -> HeldOutPart:
        """Return the held-out part without the given runs."""
        kept = [k for k, i in enumerate(self.runs) if i not in runs]
        return HeldOutPart(
            tuple(self.runs[k] for k in kept),
            tuple(self.masks[k] for k in kept),
            self.identified,
            tuple(self.residuals[k] for k in kept),
        )


def held_out_by_run(problem: Problem, solution: Solution) -> list[Array]:
    """Held-out errors at the included samples, N, one array per run (`held_out_parts`)."""
    return list(errors_by_run(solution, held_out_parts(problem, solution)).values())


def errors_by_run(
    solution: Solution,
    parts: Sequence[HeldOutPart],
    *,
    deviations: bool = True,
    counted: Sequence[Mask] | None = None,
) -> dict[int, Array]:
    """Held-out errors at the included samples, N, by run index.

    Parameters
    ----------
    solution, parts
        Fit to all runs, and its held-out parts.
    deviations
        Whether the errors contain the random effects of their run, which no model predicts. Models
        are compared without them.
    counted
        Included samples, one mask per run; by default those of the solution. Models that exclude
        different samples are compared on common ones.
    """
    samples = solution.samples
    errors: dict[int, Array] = {}
    for part in parts:
        residuals: Sequence[Array] = part.residuals
        if not deviations:
            residuals = samples.only(part.runs).without_deviations(residuals, solution.noise)
        for i, mask, residual in zip(part.runs, part.masks, residuals, strict=True):
            run_errors = errors.setdefault(i, np.zeros(len(residual)))
            run_errors[mask] = residual[mask]
    counted = samples.counted if counted is None else counted
    return {i: errors[i][counted[i]] for i in sorted(errors)}


def held_out_parts(problem: Problem, solution: Solution) -> list[HeldOutPart]:
    """Hold out each run in turn (with many runs, groups of runs), and predict it from the others.

    A parameter that the remaining runs do not identify is held at its null (or its starting value).
    Information that only the held-out run contains must not leak into its prediction, except that
    the bounds of the parameters are those for all runs. With
    a single run, two halves of alternate parts are held out in turn.
    """
    count = len(problem.campaign.prepared)
    if count == 1:
        return _halves(problem, solution)
    factors = _factors(solution, solution.samples)
    squares = _squares(solution)
    parts = []
    for group in _groups(problem.campaign):
        rest = [k for k in range(count) if k not in group]
        identified = _identified(solution, squares, squares[rest])
        kept = solution.samples.only(rest)
        of_rest = [factors[i] for i in rest]
        residuals = _predicted(problem, solution, kept, rest, of_rest, group, identified)
        masks = tuple(np.ones(len(r), dtype=bool) for r in residuals)
        parts.append(HeldOutPart(tuple(group), masks, identified, tuple(residuals)))
    return parts


def indispensable_runs(problem: Problem, solution: Solution) -> frozenset[int]:
    """Indices of the runs without which at least one parameter is not identifiable.

    A fit to the other runs does not estimate this parameter. A fit to the other runs and half of
    this run does.
    """
    count = len(problem.campaign.prepared)
    if count == 1:
        return frozenset()
    squares = _squares(solution)
    others = [[k for k in range(count) if k != i] for i in range(count)]
    return frozenset(
        i for i in range(count) if not _identified(solution, squares, squares[others[i]]).all()
    )


def held_out_halves(
    problem: Problem, solution: Solution, run: int, *, alternate: bool = False
) -> list[HeldOutPart]:
    """Hold out two halves of one run in turn; each fit uses the other half and all other runs.

    With `alternate`, the halves consist of alternate parts (`alternate_parts`), with the same kinds
    of motion. Otherwise they are the first and second half, which show whether the run is
    homogeneous.
    """
    samples, squares = solution.samples, _squares(solution)
    complete = [np.ones(len(c), dtype=bool) for c in samples.counted]
    others = squares.sum(axis=0) - squares[run]
    count = len(complete[run])
    parts_of_run = samples.settings.held_out.parts
    first = alternate_parts(count, parts_of_run) if alternate else np.arange(count) < count // 2
    parts = []
    for half in (first, ~first):
        kept = samples.within([*complete[:run], ~half, *complete[run + 1 :]])
        of_half = np.sum(solution.jacobian[run][kept.counted[run]] ** 2, axis=0)
        identified = _identified(solution, squares, (others + of_half)[None])
        parts.append(_held_out_half(problem, solution, run, half, kept, identified))
    return parts


def _squares(solution: Solution) -> Array:
    """Sums of squares of the Jacobian's columns at the included samples, shape (runs, k)."""
    pairs = zip(solution.jacobian, solution.samples.counted, strict=True)
    return np.array([np.sum(jacobian[counted] ** 2, axis=0) for jacobian, counted in pairs])


def _identified(solution: Solution, squares: Array, rest: Array) -> Mask:
    """Mask of the parameters that the remaining runs identify, shape (k,).

    `squares` and `rest` are the sums of squares of the derivatives for all runs, and for the
    remaining ones, shape (runs, k).
    """
    least = solution.samples.settings.held_out.min_information
    unidentified: Mask = rest.sum(axis=0) < least * squares.sum(axis=0)
    return ~unidentified


def _factors(solution: Solution, samples: Samples) -> list[tuple[Array, Array, int]]:
    """Innovations and derivatives of each run in triangular form, and the number of innovations.

    A Jacobian may be computed on demand, for one run at a time.
    """
    factors = []
    for i in range(len(samples.counted)):
        r, j = samples.stacked(solution.residuals, solution.jacobian, solution.noise, [i])
        factors.append((*triangular(r, j), len(r)))
    return factors


def _step(
    problem: Problem, solution: Solution, factors: Sequence[tuple[Array, Array, int]]
) -> tuple[Array, float]:
    """Gauss-Newton step within the bounds from a solution, and its square relative to noise.

    `factors` are those of the samples that the step fits (`_factors`).
    """
    r, j = (np.concatenate([f[k] for f in factors]) for k in (0, 1))
    x = problem.encode(solution.values)
    low, high = problem.encode(problem.lower) - x, problem.encode(problem.upper) - x
    step = bounded_step(r, j, np.linalg.norm(j, axis=0), (low, high), STEP_DAMPING)
    change = j @ step
    count = max(sum(f[2] for f in factors), 1)
    return step, float(change @ change) * count / max(float(r @ r), 1e-300)


def _predicted(
    problem: Problem,
    solution: Solution,
    kept: Samples,
    rest: list[int],
    factors: Sequence[tuple[Array, Array, int]],
    group: list[int],
    identified: Mask,
) -> list[Array]:
    """Residuals, N, of the runs `group` after a fit to the samples `kept` of the runs `rest`.

    `factors` are those of these samples, one entry per run in `rest`.
    """
    held = _held(problem, ~identified)
    start = _at(problem, solution, held)
    step: Array | None = None
    if not held:
        step_x, square = _step(problem, solution, factors)
        step = problem.decode(problem.encode(solution.values) + step_x, solution.values)
        # With many maxima of the likelihood, a fit to the kept samples may reach another one.
        smooth = solution.converged and not any(find_effect(e).peaks for e in solution.effects)
        if smooth and square <= SHORT**2 * len(step_x):
            residuals = problem.residuals(step, group)
            if _straight(solution, step_x, group, residuals):
                return residuals
    part = problem.restricted(problem.campaign.only(rest), held)
    if step is not None:
        # The solution of a law that fits badly is not a reliable starting point.
        start = min((step, start), key=lambda v: part.square(v, kept))
    return problem.residuals(_fitted(part, kept, start, solution), group)


def _fitted(part: Problem, kept: Samples, start: Array, solution: Solution) -> Array:
    """Parameter values after a short search from `start`, with the noise of a solution."""
    if not part.open:
        return start
    noise = solution.noise
    return search(part, kept, start, noise, EVALUATIONS, least_gain=NEAR_MINIMUM).values


def _straight(solution: Solution, step_x: Array, group: list[int], residuals: list[Array]) -> bool:
    """Whether the predictions of a group of runs are linear in the parameters along a step."""
    error, moved, size = 0.0, 0.0, 0.0
    for i, refitted in zip(group, residuals, strict=True):
        counted = solution.samples.counted[i]
        residual, change = solution.residuals[i][counted], (solution.jacobian[i] @ step_x)[counted]
        error += float(np.sum((residual - change - refitted[counted]) ** 2))
        moved += float(np.sum(change**2))
        size += float(np.sum(residual**2))
    return error <= STRAIGHT**2 * moved + (STRAIGHT * NOTHING) ** 2 * size


def _groups(campaign: Campaign) -> list[list[int]]:
    """Groups of runs that are held out together, with similar kinds of motion in each group.

    The runs are distributed by direction, top speed and name, so that the groups do not depend on
    the order of the runs.
    """
    speeds = [p.motion.velocity for p in campaign.prepared]
    order = sorted(
        range(len(speeds)),
        key=lambda i: (
            round(float(np.mean(np.sign(speeds[i])))),
            float(f"{np.max(np.abs(speeds[i]), initial=0.0):.2g}"),
            campaign.prepared[i].run.name,
        ),
    )
    folds = min(campaign.settings.held_out.max_folds, len(order))
    return [sorted(order[k::folds]) for k in range(folds)]


def _held(problem: Problem, unidentified: Mask) -> dict[str, float]:
    """Parameters that are not identifiable, by name, with their null or starting value."""
    names = [problem.names[i] for i in np.asarray(problem.open)[unidentified]]
    return {name: null_or_start(problem.parameters[name]) for name in names}


def _at(problem: Problem, solution: Solution, held: dict[str, float]) -> Array:
    """Parameter values of a solution, with the values in `held` replaced."""
    values = zip(problem.names, solution.values.tolist(), strict=True)
    return np.array([held.get(name, value) for name, value in values])


def _halves(problem: Problem, solution: Solution) -> list[HeldOutPart]:
    """Hold out two halves of a single run, consisting of alternate parts, in turn."""
    first = alternate_parts(
        len(solution.samples.counted[0]), solution.samples.settings.held_out.parts
    )
    parts = []
    for half in (~first, first):
        kept = solution.samples.within([~half])
        identified = np.ones(solution.free, dtype=bool)
        parts.append(_held_out_half(problem, solution, 0, half, kept, identified))
    return parts


def _held_out_half(
    problem: Problem, solution: Solution, run: int, half: Mask, kept: Samples, identified: Mask
) -> HeldOutPart:
    """Hold out half of a run, and predict it from the samples `kept` of all runs."""
    all_runs, factors = list(range(len(kept.counted))), _factors(solution, kept)
    residuals = _predicted(problem, solution, kept, all_runs, factors, [run], identified)
    return HeldOutPart((run,), (half,), identified, tuple(residuals))


def alternate_parts(count: int, parts: int) -> Mask:
    """Mask, shape (count,), of the first, third, ... of `parts` equal parts of a run."""
    return np.asarray((np.arange(count) * parts // max(count, 1)) % 2 == 0)
