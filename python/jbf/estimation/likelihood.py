"""Log-likelihood gain of one solution over another, score tests, and noise at given values.

Gains are 2 x the difference of log likelihood. A score test predicts the gain of a step before the
step is made.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from jbf.arrays import Array
from jbf.estimation.least_squares import unexplained_square
from jbf.estimation.noise import WHITE, Noise, estimate_noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples, common_samples
from jbf.estimation.settings import DEFAULT, NoiseSettings
from jbf.estimation.solution import Lines, Solution
from jbf.estimation.variance import clipped_square, robust_size, significant_inflation


def likelihood_gain(richer: Solution, simpler: Solution) -> float:
    """Log-likelihood gain of the richer solution over the simpler one, on common sample weights.

    For each sample the smaller of the two models' weights is used. Each solution is evaluated with
    the noise models of both, and its larger likelihood counts. Otherwise, a solution with a noise
    model that fits poorly, such as white noise from `settle`, would make the other appear better.
    """
    shared = common_samples(richer.samples, simpler.samples)
    richer, simpler = (
        solution if solution.samples is shared else replace(solution, samples=shared)
        for solution in (richer, simpler)
    )
    # Errors of the motion and random effects determine the covariance with the noise.
    if richer.noise == simpler.noise or shared.motion is not None or shared.between is not None:
        return simpler.cost - richer.cost
    richer_cost, simpler_cost = (
        min(solution.cost, shared.cost(solution.residuals, other.noise))
        for solution, other in ((richer, simpler), (simpler, richer))
    )
    return simpler_cost - richer_cost


def log_likelihood(solution: Solution) -> float:
    """Log-likelihood of the whitened residuals at a solution, with the variance estimated.

    Notes
    -----
    With n whitened, weighted residuals of mean square s^2, and the covariance s^2 C of the noise,
    ``-2 log L = n (log(2 pi s^2) + 1) + log det C``. The filter of coloured noise has a unit
    determinant. Weights contribute ``-2 sum(log w)``; random effects and the errors of the motion
    contribute the determinants of their covariances.
    """
    samples = solution.samples
    count = sum(int(np.count_nonzero(w)) for w in samples.weight)
    constant = count * (np.log(2.0 * np.pi) + 1.0)
    return float(-0.5 * (constant + solution.cost + _log_determinant(solution, count)))


def _log_determinant(solution: Solution, count: int) -> float:
    """Log determinant of the covariance of the noise, in units of its estimated variance."""
    samples = solution.samples
    if samples.motion is not None:
        log_determinant = samples.motion.whitening(samples.weight).log_determinant
        between = samples.log_determinant_between(solution.noise)
        return log_determinant - 2.0 * count * float(np.log(samples.motion.noise)) + between
    weights = -2.0 * sum(float(np.sum(np.log(w[w > 0.0]))) for w in samples.weight)
    return weights + samples.log_determinant_between(solution.noise)


_shares: WeakKeyDictionary[Solution, float] = WeakKeyDictionary()


def effective_share(solution: Solution) -> float:
    """Effective number of independent samples divided by the number of samples, 0 to 1."""
    if solution not in _shares:
        samples = solution.samples
        innovations = samples.weighted_innovations(solution.residuals, solution.noise)
        _shares[solution] = independent_share(innovations, samples.steps_s, samples.settings.noise)
    return _shares[solution]


def share_of_gain(richer: Solution, simpler: Solution, share: float) -> float:
    """Factor, at most one, that corrects a log-likelihood gain for correlated innovations.

    The factor is the smaller of two estimates. One is the share of independent samples, `share`,
    the other follows from the long-run variance of the score in the direction in which the two
    solutions differ.
    """
    samples = common_samples(richer.samples, simpler.samples)
    e_richer, e_simpler = _innovations(richer, simpler, samples)
    inflation = significant_inflation(
        [before - after for after, before in zip(e_richer, e_simpler, strict=True)],
        e_richer,
        samples.steps_s,
        samples.settings.variance,
    )
    return min(share, 1.0 / inflation)


def robust_gain(richer: Solution, simpler: Solution) -> float:
    """Log-likelihood gain in which the contribution of each sample is bounded.

    Residuals are clipped at a few robust standard deviations of those of the richer solution.
    """
    samples = common_samples(richer.samples, simpler.samples)
    e_richer, e_simpler = map(np.concatenate, _innovations(richer, simpler, samples))
    size, clip = robust_size(e_richer), samples.settings.noise.clip_sigma
    square = clipped_square(e_richer, size, clip)
    # After an exact fit to most samples, no sample counts as an outlier.
    if square <= 0.0:
        return np.inf
    return len(e_richer) * (clipped_square(e_simpler, size, clip) / square - 1.0)


def _innovations(
    richer: Solution, simpler: Solution, samples: Samples
) -> tuple[list[Array], list[Array]]:
    """Innovations of two solutions with the noise of the richer one, one array per run.

    The correlation due to the random effects of a run is removed.
    """
    by_run = [
        [samples.whitened(s.residuals, richer.noise, [i]) for i in range(len(samples.runs))]
        for s in (richer, simpler)
    ]
    return by_run[0], by_run[1]


def independent_share(
    innovations: Sequence[Array],
    steps: Sequence[float],
    settings: NoiseSettings = DEFAULT.noise,
) -> float:
    """Effective share of independent samples among the given innovations, 0 to 1.

    The innovations of a correct model are white. Those of a wrong model are autocorrelated, and n
    of them contain the information of fewer independent samples (Bartlett 1946). The
    autocorrelations are summed up to the first insignificant one or the longest correlation time of
    noise.
    """
    count = max(sum(len(e) for e in innovations), 1)
    longest = int(settings.longest_memory_s / min(steps)) + 1
    total = np.zeros(longest + 1)
    middle = sum(float(np.sum(e)) for e in innovations) / count
    for e in innovations:
        n = len(e)
        if n == 0:
            continue  # a run of which no sample is included
        power = np.fft.irfft(np.abs(np.fft.rfft(e - middle, 2 * n)) ** 2)[: min(n, len(total))]
        total[: len(power)] += power
    if total[0] <= 0.0:
        return 1.0
    rho = total[1:] / total[0]
    sunk = np.flatnonzero(rho < 2.0 / np.sqrt(count))
    end = int(sunk[0]) if len(sunk) else len(rho)
    return float(1.0 / (1.0 + 2.0 * np.sum(rho[:end])))


def score_gain(problem: Problem, values: Array, near: Solution) -> float:
    """Score test statistic: log-likelihood gain predicted for a model at its null.

    The prediction is that of one full Gauss-Newton step from `values`, with the noise of the
    solution `near`.
    """
    return promised_gain(*problem.gauss_newton_rows(values, near.samples, near.noise))


def next_step_gain(solution: Solution) -> float:
    """Log-likelihood gain that the next Gauss-Newton step predicts; small after convergence."""
    r, j = solution.stacked()
    return promised_gain(r, j, len(r))


def promised_gain(r: Array, j: Array, count: int) -> float:
    """Log-likelihood gain that a Gauss-Newton step predicts, from innovations and Jacobian.

    `count` is the number of innovations before their reduction to triangular form.
    """
    remaining = max(unexplained_square(j, r), 1e-300)
    return count * float(np.log(max(float(r @ r), 1e-300) / remaining))


def noise_at(
    problem: Problem, samples: Samples, values: Array, lines: Lines | None = None
) -> Noise:
    """Estimate the noise model of the residuals at some values, without the random effects of runs.

    Of many samples, those of selected runs are used (`Problem.searched`). `lines` holds the
    residuals and derivatives of all runs at these values, if they are known.
    """
    selection = problem.searched
    samples = samples if len(selection) == len(samples.runs) else samples.only(selection)
    residuals = (
        problem.residuals(values, selection) if lines is None else [lines[0][i] for i in selection]
    )
    residuals = samples.without_deviations(residuals, WHITE)
    masked = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
    most_n, settings = problem.campaign.most_noise_n, samples.settings.noise
    return estimate_noise(masked, samples.steps_s, samples.counted, most_n, settings)
