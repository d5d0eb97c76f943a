"""What one solution gains over another, in units of the log likelihood."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from jbf.estimation.fit import Problem, Solution
from jbf.estimation.noise import Noise, independent_share, innovation_cost

Array = npt.NDArray[np.float64]


def costs(a: Solution, b: Solution) -> tuple[float, float]:
    """The costs of two solutions, each sample with the smaller of the weights they give it."""
    if a.campaign is b.campaign:
        return a.cost, b.cost
    pairs = zip(a.campaign.prepared, b.campaign.prepared, strict=True)
    weights = [np.minimum(p.weight, q.weight) for p, q in pairs]
    steps = [p.step_s for p in a.campaign.prepared]

    def cost(solution: Solution) -> float:
        weighted = [r * w for r, w in zip(solution.residuals, weights, strict=True)]
        return innovation_cost(solution.noise, weighted, steps, [w > 0.0 for w in weights])

    return cost(a), cost(b)


def independent(solution: Solution) -> float:
    """How many independent samples a sample is worth, by the innovations of a solution, 0 to 1."""
    prepared = solution.campaign.prepared
    pairs = zip(solution.residuals, prepared, strict=True)
    left = [solution.noise.innovations(r * p.weight, p.step_s) * (p.weight > 0.0) for r, p in pairs]
    return independent_share(left, [p.step_s for p in prepared])


def first_step_gain(problem: Problem, values: Array, noise: Noise) -> float:
    """Gain in twice the log likelihood that one full Gauss-Newton step from `values` promises."""
    return _promised(*problem.stacked(*problem.linearise(values), noise))


def next_step_gain(problem: Problem, solution: Solution) -> float:
    """The same of a step from a solution: nothing where it has converged."""
    return _promised(
        *problem.on(solution.campaign).stacked(
            solution.residuals, solution.jacobian, solution.noise
        )
    )


def _promised(r: Array, j: Array) -> float:
    size = np.linalg.norm(j, axis=0)
    unit = j[:, size > 0.0] / size[size > 0.0]
    step, *_ = np.linalg.lstsq(unit, r, rcond=1e-10)
    left = r - unit @ step
    return len(r) * float(np.log(max(float(r @ r), 1e-300) / max(float(left @ left), 1e-300)))
