"""Do the runs agree on the parameters? A right model has one set of them; of a confounder each run
asks for its own.

The score test of parameter constancy (Nyblom 1989, with runs for groups): at the fit to all runs,
what one Gauss-Newton step would gain for each run alone is chi-square, as many degrees of freedom
as the runs have parameters to themselves less those that they share. Scores are in units of each
run's own long-run variance. It costs no fit.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.diagnosis.ledger import Remainder
from jbf.diagnosis.policy import DEFAULT, Policy
from jbf.estimation.long_run import score_square
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.catalogue import find_effect
from jbf.models.parameter_units import shown_name, unit_of

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SENSITIVE = 1e-3
"""A direction in which a run moves with the parameters less than this share of its best is none."""
OIL = {"U_tr_m_s", "gamma"}
"""What the oil's warmth moves together: a run whose one differs has another of the other."""
TOLD = float(np.log(20.0))
"""Largest change of a logarithm that is told as a number: one Gauss-Newton step knows no larger."""
NAMED = 3
"""Runs named in the description."""


@dataclass(frozen=True)
class Disagreement:
    """How far the runs disagree on the parameters.

    Attributes
    ----------
    gain
        What parameters of their own would gain the runs, in twice the log likelihood.
    degrees
        How much of it chance gives; zero where there is but one run.
    by_run
        Run to its gain over its degrees of freedom, largest first.
    """

    gain: float
    degrees: int
    by_run: dict[str, float]

    def beyond_chance(self, policy: Policy = DEFAULT) -> bool:
        """True where one set of parameters cannot be right for all runs."""
        if self.degrees == 0 or self.gain <= policy.constancy_ratio * self.degrees:
            return False
        return bool(special.chdtrc(self.degrees, self.gain) < policy.constancy_chance)


def disagreement(problem: Problem, solution: Solution, effect: str | None = None) -> Disagreement:
    """How far the runs disagree on the parameters of a solution.

    Parameters
    ----------
    effect
        Its parameters alone, what the others could explain in each run taken out; all where not
        given, but for those of effects with many peaks.
    """
    # Samples beside a jump whose instant is fitted tell that instant with errors of their own.
    samples = solution.samples.tested()
    aside = _of_many_peaks(problem) if effect is None else ~_of(problem, {effect})
    if samples.between is not None:
        # In what they are known to differ runs do not agree, by more than to first order.
        known = set(samples.between.names)
        if known & OIL:
            known |= OIL
        aside = aside | np.array([problem.names[i] in known for i in problem.open])
    residuals, jacobian, noise = solution.residuals, solution.jacobian, solution.noise
    parts = [
        _set_aside(*samples.stacked(residuals, jacobian, noise, [i]), aside)
        for i in range(len(residuals))
    ]
    size = np.sqrt(np.sum([np.sum(j**2, axis=0) for _, j in parts], axis=0))
    scale = np.where(size > 0.0, size, 1.0)
    gain, degrees, by_run = 0.0, 0, {}
    together: list[tuple[Array, Array]] = []
    for (r, j), name, step_s in zip(parts, samples.runs, samples.steps_s, strict=True):
        directions = _directions(j / scale)
        count = directions.shape[1]
        if len(r) <= count:
            continue
        sigma = max(float(np.sqrt(np.mean(r**2))), 1e-150)
        own = score_square(directions, r / sigma, step_s)
        gain += own
        degrees += count
        by_run[name] = own / max(count, 1)
        together.append((r / sigma, j / scale / sigma))
    ranked = dict(sorted(by_run.items(), key=lambda item: -item[1]))
    if len(together) < 2:
        return Disagreement(0.0, 0, ranked)
    # What parameters in common would gain is no disagreement: at a bound, or where the colour of
    # the noise is not all forgiven, the fit does not stand on the top.
    r, j = (np.concatenate(a) for a in zip(*together, strict=True))
    common = float(np.sum((_directions(j).T @ r) ** 2))
    shared = int(np.sum(size > 0.0))
    return Disagreement(max(gain - common, 0.0), max(degrees - shared, 1), ranked)


def _of(problem: Problem, effects: Collection[str]) -> Mask:
    """True at search variables of these effects."""
    return np.array([problem.names[i].split(".")[0] in effects for i in problem.open], dtype=bool)


def _of_many_peaks(problem: Problem) -> Mask:
    """True at search variables of effects whose likelihood has peak beside peak."""
    return _of(problem, {name for name in problem.effects if find_effect(name).peaks})


def _directions(j: Array) -> Array:
    """Directions of the record, orthonormal columns, that the parameters move it in."""
    directions, size, _ = np.linalg.svd(j, full_matrices=False)
    found: Array = directions[:, size > SENSITIVE * max(float(size.max(initial=0.0)), 1e-300)]
    return found


def _set_aside(r: Array, j: Array, aside: Mask) -> tuple[Array, Array]:
    """Residuals and derivatives with what the parameters set aside could explain taken out: of an
    effect whose likelihood has peak beside peak each run may have the one that its errors of
    motion choose."""
    if not aside.any():
        return r, j
    taken = _directions(j[:, aside])
    rest = j[:, ~aside]
    return r - taken @ (taken.T @ r), rest - taken @ (taken.T @ rest)


def find_disagreement(problem: Problem, solution: Solution, policy: Policy) -> list[Remainder]:
    """That the runs ask for different parameters, if they do."""
    found = disagreement(problem, solution)
    if not found.beyond_chance(policy):
        return []
    ranked = list(found.by_run)[:NAMED]
    first, others = ranked[0], [n for n in ranked[1:] if found.by_run[n] > policy.constancy_ratio]
    where = (
        f"the runs ask for parameters that differ: run {first} asks for "
        f"{own_step(problem, solution, first)} ({found.by_run[first]:.0f} times as much as by "
        "chance); check its load, zero and temperature"
    )
    if others:
        where += f" (next: {', '.join(others)})"
    share = min((found.gain - found.degrees) / solution.samples.count, 1.0)
    return [Remainder("parameters", where, share)]


def own_step(problem: Problem, solution: Solution, run: str) -> str:
    """The parameter that gains a run most where it alone is the run's own, and how it differs there
    by one Gauss-Newton step, in words."""
    samples = solution.samples.tested()
    i = samples.runs.index(run)
    r, j = samples.stacked(solution.residuals, solution.jacobian, solution.noise, [i])
    size = np.linalg.norm(j, axis=0)
    asked = (size > 0.0) & ~_of_many_peaks(problem)
    size = np.where(asked, size, np.inf)
    gain = np.abs(j.T @ r) / size
    best = int(np.argmax(gain))
    step = float(j[:, best] @ r) / float(size[best]) ** 2
    place = problem.open[best]
    name, page = problem.names[place], problem.parameters[problem.names[place]]
    unit = unit_of(name, page, problem.law, problem.campaign.rig.quantities)
    said = shown_name(name, page, unit)
    more = "higher" if step > 0.0 else "lower"
    if problem.log[place]:
        part = float(np.expm1(np.clip(step, -TOLD, TOLD)))
        if abs(step) > TOLD:
            # One step says no more than this of a value so far off.
            return f"{said} many times as {'large' if step > 0.0 else 'small'}"
        return f"{said} {100.0 * abs(part):.3g} % {more}"
    return f"{said} {abs(step):.2g}{'' if unit == '-' else f' {unit}'} {more}"
