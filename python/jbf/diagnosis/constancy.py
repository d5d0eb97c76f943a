"""Do the runs agree on the parameters? A right model has one set of them; of a stand-in each run
asks for its own.

The score test of parameter constancy (Nyblom 1989, with runs for groups): at the fit to all runs,
what one Gauss-Newton step would gain for each run alone is chi-square, as many degrees of freedom
as the runs have parameters to themselves less those that they share. It costs no fit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy import stats

from jbf.diagnosis.result import Remainder
from jbf.estimation.fit import Problem, Solution
from jbf.models.catalogue import find_effect

Array = npt.NDArray[np.float64]

CHANCE = 1e-8
"""Probability that runs of one model differ so,"""
TIMES = 2.5
"""and how many times its degrees of freedom the chi-square must be, besides: noise is never quite
what it is taken for."""
FELT = 1e-3
"""A direction in which a run feels the parameters less than this share of its best is none."""
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

    @property
    def beyond_chance(self) -> bool:
        """True where one set of parameters cannot be right for all runs."""
        if self.degrees == 0 or self.gain <= TIMES * self.degrees:
            return False
        return bool(stats.chi2.sf(self.gain, self.degrees) < CHANCE)


def disagreement(problem: Problem, solution: Solution) -> Disagreement:
    """How far the runs disagree on the parameters of a solution."""
    # Samples beside a jump whose instant is fitted tell that instant with errors of their own.
    sure = [
        replace(p, weight=np.where(p.trusted, p.weight, 0.0)) for p in solution.campaign.prepared
    ]
    problem = problem.on(solution.campaign.of(sure))
    many = {name for name in problem.effects if find_effect(name).peaks}
    rings = [problem.names[i].split(".")[0] in many for i in problem.open]
    parts = [
        _apart(
            *problem.stacked(solution.residuals, solution.jacobian, solution.noise, [i]),
            np.array(rings),
        )
        for i in range(len(solution.residuals))
    ]
    size = np.sqrt(np.sum([np.sum(j**2, axis=0) for _, j in parts], axis=0))
    scale = np.where(size > 0.0, size, 1.0)
    gain, degrees, by_run = 0.0, 0, {}
    together: list[tuple[Array, Array]] = []
    for (r, j), p in zip(parts, solution.campaign.prepared, strict=True):
        clear = _felt(j / scale)
        count = clear.shape[1]
        if len(r) <= count:
            continue
        sigma = max(float(np.sqrt(np.mean(r**2))), 1e-150)
        own = float(np.sum((clear.T @ (r / sigma)) ** 2))
        gain += own
        degrees += count
        by_run[p.run.name] = own / max(count, 1)
        together.append((r / sigma, j / scale / sigma))
    ranked = dict(sorted(by_run.items(), key=lambda item: -item[1]))
    if len(together) < 2:
        return Disagreement(0.0, 0, ranked)
    # What parameters in common would gain is no disagreement: at a bound, or where the colour of
    # the noise is not all forgiven, the fit does not stand on the top.
    r, j = (np.concatenate(a) for a in zip(*together, strict=True))
    common = float(np.sum((_felt(j).T @ r) ** 2))
    shared = int(np.sum(size > 0.0))
    return Disagreement(max(gain - common, 0.0), max(degrees - shared, 1), ranked)


def _felt(j: Array) -> Array:
    """Directions of the record, orthonormal columns, that the parameters move it in."""
    directions, felt, _ = np.linalg.svd(j, full_matrices=False)
    found: Array = directions[:, felt > FELT * max(float(felt.max(initial=0.0)), 1e-300)]
    return found


def _apart(r: Array, j: Array, aside: npt.NDArray[np.bool_]) -> tuple[Array, Array]:
    """Residuals and derivatives with what the parameters set aside could explain taken out: of an
    effect whose likelihood has peak beside peak each run may have the one that its errors of
    motion choose."""
    if not aside.any():
        return r, j
    taken = _felt(j[:, aside])
    rest = j[:, ~aside]
    return r - taken @ (taken.T @ r), rest - taken @ (taken.T @ rest)


def find_disagreement(problem: Problem, solution: Solution) -> list[Remainder]:
    """That the runs ask for different parameters, if they do."""
    found = disagreement(problem, solution)
    if not found.beyond_chance:
        return []
    samples = sum(int(p.trusted.sum()) for p in solution.campaign.prepared)
    runs = ", ".join(list(found.by_run)[:NAMED])
    where = (
        f"the runs ask for parameters that differ ({found.gain / found.degrees:.0f} times as much "
        f"as by chance), most of all {runs}"
    )
    return [Remainder("parameters", where, min((found.gain - found.degrees) / samples, 1.0))]
