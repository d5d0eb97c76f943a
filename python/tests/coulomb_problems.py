"""Problems, samples and solutions of jbf whose least squares are linear regressions.

Coulomb's law on motions without reversals (`by_hand.four_runs`) is linear in its parameters.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from by_hand import LAW, Array
from jbf import Rig, Run
from jbf.estimation.campaign import Campaign
from jbf.estimation.noise import WHITE, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from scipy import signal

STEP_S = 0.02
HELD = {"F_s": 6.0}
"""Breakaway friction (N), which motions without reversals do not determine."""
VALUES = {**LAW, **HELD}


def coulomb_problem(runs: Sequence[Run], effects: Sequence[str] = ()) -> Problem:
    """Coulomb's law with effects; breakaway friction is fixed."""
    return Problem(Campaign.prepare(Rig(), list(runs)), "coulomb", "journal", effects, HELD)


def values_of(problem: Problem, **changed: float) -> Array:
    """True values of the law and first starting values of the effects, with changes."""
    pages = problem.parameters
    known = {name: page.starts[0] for name, page in pages.items()} | VALUES | changed
    return np.array([known[name] for name in problem.names])


def solution_at(problem: Problem, values: Array, noise: Noise = WHITE) -> Solution:
    """Solution with the given parameter values at the samples of the campaign."""
    return problem.solution(values, problem.campaign.samples, noise)


def samples_of(
    weight: Sequence[Array],
    counted: Sequence[npt.NDArray[np.bool_]] | None = None,
    step_s: float = STEP_S,
) -> Samples:
    """Samples with the given weights, one array for each run; by default all weights are one."""
    masks = [w > 0.0 for w in weight] if counted is None else counted
    names = tuple(f"run {i}" for i in range(len(weight)))
    return Samples(names, (step_s,) * len(weight), tuple(masks), tuple(weight))


def solution_of(
    residuals: Sequence[Array],
    samples: Samples,
    jacobian: Sequence[Array] | None = None,
    noise: Noise = WHITE,
) -> Solution:
    """A solution with the given residuals and with all parameter values zero."""
    slopes = [np.zeros((len(r), 0)) for r in residuals] if jacobian is None else list(jacobian)
    values = np.zeros(slopes[0].shape[1])
    return Solution((), values, list(residuals), slopes, noise, True, "", samples)


def autoregressive(seed: int, memory_s: float, sd: float, n: int, step_s: float = STEP_S) -> Array:
    """First-order autoregressive noise with a correlation time (s) and a standard deviation."""
    phi = float(np.exp(-step_s / memory_s))
    kicks = np.random.default_rng(seed).normal(0.0, sd * np.sqrt(1.0 - phi**2), n + 500)
    noise: Array = signal.lfilter([1.0], [1.0, -phi], kicks)[500:]
    return noise


def arma_innovations(values: Array, step_s: float, noise: Noise) -> Array:
    """Innovations `e_t = r_t - phi r_t-1 + phi (1 - colour) e_t-1` by SciPy on the first axis."""
    phi = float(np.exp(-step_s / noise.memory_s)) if noise.colour else 0.0
    numerator, denominator = [1.0, -phi], [1.0, -phi * (1.0 - noise.colour)]
    innovations: Array = signal.lfilter(numerator, denominator, values, axis=0)
    return innovations
