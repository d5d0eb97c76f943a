"""What one solution gains over another, in units of twice the log likelihood; and score tests: what
a step would gain, before it is made."""

from __future__ import annotations

from collections.abc import Sequence
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from jbf.estimation.long_run import sure_inflation
from jbf.estimation.noise import LONGEST_MEMORY_S, Noise
from jbf.estimation.problem import Problem
from jbf.estimation.robust import clipped_square, robust_size
from jbf.estimation.rows import triangular
from jbf.estimation.samples import Samples, least_weights
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

INDEPENDENT = 1e-10
"""Singular values of a design, as a share of the largest, of directions that are its own."""


def likelihood_gain(richer: Solution, simpler: Solution) -> float:
    """Gain in twice the log likelihood, each sample with the smaller of the weights that the two
    models give it."""
    if richer.samples is simpler.samples:
        return simpler.cost - richer.cost
    shared = least_weights(richer.samples, simpler.samples)
    richer_cost, simpler_cost = (
        shared.cost(solution.residuals, solution.noise) for solution in (richer, simpler)
    )
    return simpler_cost - richer_cost


_shares: WeakKeyDictionary[Solution, float] = WeakKeyDictionary()


def effective_share(solution: Solution) -> float:
    """How many independent samples a sample is worth, by the innovations of a solution, 0 to 1."""
    if solution not in _shares:
        samples = solution.samples
        left = samples.weighted_innovations(solution.residuals, solution.noise)
        _shares[solution] = independent_share(left, samples.steps_s)
    return _shares[solution]


def share_of_gain(richer: Solution, simpler: Solution) -> float:
    """How much a gain counts for that one solution has over another: less than one where what is
    left is no white noise, by all its autocorrelations, or by the long-run variance of the score in
    the direction in which the two differ, whichever is less."""
    share = effective_share(richer)
    samples = least_weights(richer.samples, simpler.samples)
    left, ways = [], []
    for i in range(len(samples.runs)):
        own, before = (
            _whitened(samples, s.residuals[i], richer.noise, i) for s in (richer, simpler)
        )
        left.append(own)
        ways.append(before - own)
    return min(share, 1.0 / sure_inflation(ways, left, samples.steps_s))


def gain_of_most(richer: Solution, simpler: Solution) -> float:
    """A gain on which no sample has more than a bounded influence: squares count no further than to
    a few standard deviations of what the richer one leaves of most."""
    samples = least_weights(richer.samples, simpler.samples)
    own, before = (
        np.concatenate(
            [_whitened(samples, r, richer.noise, i) for i, r in enumerate(solution.residuals)]
        )
        for solution in (richer, simpler)
    )
    size = robust_size(own)
    left = clipped_square(own, size)
    # Where most is fitted exactly no sample is off.
    return len(own) * (clipped_square(before, size) / left - 1.0) if left > 0.0 else np.inf


def _whitened(samples: Samples, residual: Array, noise: Noise, run: int) -> Array:
    """Innovations of a run, free of the correlation that its deviations make."""
    return samples.only([run]).stacked([residual], [np.zeros((len(residual), 0))], noise)[0]


def independent_share(innovations: Sequence[Array], steps: Sequence[float]) -> float:
    """How many independent samples one sample of these innovations is worth, 0 to 1.

    Innovations of noise alone are white. Those of a wrong model are not, and n samples of them tell
    less than n (Bartlett 1946): the autocorrelations are summed until they sink into chance, or
    are older than any noise.
    """
    count = max(sum(len(e) for e in innovations), 1)
    longest = int(LONGEST_MEMORY_S / min(steps)) + 1
    total = np.zeros(longest + 1)
    middle = sum(float(np.sum(e)) for e in innovations) / count
    for e in innovations:
        n = len(e)
        power = np.fft.irfft(np.abs(np.fft.rfft(e - middle, 2 * n)) ** 2)[: min(n, len(total))]
        total[: len(power)] += power
    if total[0] <= 0.0:
        return 1.0
    rho = total[1:] / total[0]
    sunk = np.flatnonzero(rho < 2.0 / np.sqrt(count))
    end = int(sunk[0]) if len(sunk) else len(rho)
    return float(1.0 / (1.0 + 2.0 * np.sum(rho[:end])))


def score_gain(problem: Problem, values: Array, near: Solution) -> float:
    """The score test of a model at its null: the gain in twice the log likelihood that one full
    Gauss-Newton step from `values` promises, under the noise of a solution nearby."""
    return promised_gain(*problem.gauss_newton_rows(values, near.samples, near.noise))


def next_step_gain(solution: Solution) -> float:
    """The same of a step from a solution: nothing where it has converged."""
    r, j = solution.stacked()
    return promised_gain(r, j, len(r))


def promised_gain(r: Array, j: Array, count: int) -> float:
    """The same from rows of a likelihood of so many innovations: residual, derivatives."""
    left = max(unexplained_square(j, r), 1e-300)
    return count * float(np.log(max(float(r @ r), 1e-300) / left))


def least_squares(design: Array, target: Array) -> Array:
    """The shortest step along a design's columns, each of unit length, that explains a target
    best."""
    size = np.linalg.norm(design, axis=0)
    size[size <= 0.0] = 1.0
    left, axes = triangular(target, design / size)
    step, *_ = np.linalg.lstsq(axes, left, rcond=INDEPENDENT)
    return np.asarray(step / size)


def unexplained(design: Array, target: Array) -> Array:
    """What of a target linear combinations of a design's columns do not explain."""
    # By powers of two, which round nothing: squares of what stands far above no noise overflow.
    _, power = np.frexp(np.max(np.abs(design), axis=0, initial=0.0))
    design = np.ldexp(design, -power)
    size = np.linalg.norm(design, axis=0)
    design = design[:, size > 0.0] / size[size > 0.0]
    step, *_ = np.linalg.lstsq(design, target, rcond=INDEPENDENT)
    return np.asarray(target - design @ step)


def spanned(design: Array) -> Array:
    """Orthonormal columns that span those of a design, shape (n, rank)."""
    _, power = np.frexp(np.max(np.abs(design), axis=0, initial=0.0))
    design = np.ldexp(design, -power)
    size = np.linalg.norm(design, axis=0)
    axes, sizes, _ = np.linalg.svd(design[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    span: Array = axes[:, sizes > INDEPENDENT * np.max(sizes, initial=0.0)]
    return span


def unexplained_square(design: Array, target: Array) -> float:
    """Sum of squares of that."""
    left = unexplained(design, target)
    return float(left @ left)
