"""Likelihood of time delays on a grid.

The sum of squares is discontinuous in the delay where a jump passes a sample, so neither its
gradient nor its curvature determines the delay. `scan_delays` shifts the force of each run in time
and finds large delays; parts of a run show whether the delay grows. `exact_delay` refines the delay
parameter of a model.

Notes
-----
A search interpolates a delayed force linearly between samples. The likelihood is then
differentiable in the delay, but samples next to a jump have little weight. These samples contain
most information on the delay: each shows whether it was read before or after a reversal.
`exact_delay` therefore evaluates the model one delay before each sample. The distribution of a
sample close to a reversal is a mixture of both sides of the jump. The other parameters change with
the delay such that the objective is minimal to first order.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import special

from jbf.arrays import Array
from jbf.estimation.delays import fine_force
from jbf.estimation.likelihood import independent_share
from jbf.estimation.problem import Problem
from jbf.estimation.random_effects import spread_between
from jbf.estimation.settings import DelaySettings
from jbf.estimation.solution import Solution
from jbf.estimation.standard_errors import StandardErrors
from jbf.models.delayed_reading import TAU, DelayedChain

LEAST_STEPS = 0.05
"""Smallest resolvable delay, in sampling intervals: a jump then occurs at another sample."""
REACH = 5.0
"""Half-width of the delay scan, in standard errors of the search."""
LEAST_REACH_STEPS = 0.2
"""Minimum half-width of the delay scan, in sampling intervals."""
COARSE, FINE = 31, 17
"""Number of delays in the first scan, and in a second one around the most likely delay."""
CLIPPED = 5.0
"""Limit of the contribution of a residual to the cost, in standard deviations."""
BLURRED = 3.5
"""Distance from a jump, in standard errors of its time, within which its side is uncertain."""


@dataclass(frozen=True)
class Delays:
    """Estimated time delays of the force in a set of runs.

    Attributes
    ----------
    delays_s
        Delay in the middle of each run, s.
    drift
        Increase of the delay per second (relative clock drift).
    spread_s
        Standard deviation of the delay between runs, s; zero if the runs do not differ.
    """

    delays_s: tuple[float, ...]
    drift: float
    spread_s: float


@dataclass(frozen=True)
class _Estimate:
    """Estimated value with its variance; without an estimate the variance is infinite."""

    value: float = 0.0
    variance: float = np.inf


def scan_delays(problem: Problem, solution: Solution, look: int, chance: float) -> Delays | None:
    """Estimate the differences between the delays of the runs; None if they are not significant.

    All samples are used, including those next to reversals. They resolve a delay of less than one
    sampling interval only if the friction is smooth in time. A delay common to all runs may be that
    of the instrument, which is the effect `time_delay`. A force that precedes the motion in all
    runs is a recording artefact.

    Parameters
    ----------
    look
        Index of the search range in `DelaySettings.search_ranges_s`: 0 for the first scan, 1 if the
        runs were shifted before.
    chance
        Significance level for differences between runs and for a common drift.
    """
    settings = problem.campaign.settings.delays
    ranges = settings.search_ranges_s
    reach, step = ranges[min(look, len(ranges) - 1)]
    grid = np.arange(-reach, reach + 0.5 * step, step)
    delays, drifts = [], []
    for squares, time in _scans(problem, solution, grid):
        delays.append(_grid_estimate(grid, squares.sum(axis=1), squares.shape[1], settings))
        drifts.append(_drift(grid, squares, time, settings))
    runs, min_runs = problem.campaign.prepared, problem.campaign.settings.variance.min_runs
    spread, drift = _spread(delays, min_runs), _common(drifts)
    differ = spread is not None and spread[1] < chance
    drifting = drift is not None and drift[1] < chance
    if not differ and not drifting:
        common = _common(delays)
        if common is None or common[0] >= 0.0 or common[1] >= chance:
            return None
        return Delays(tuple(common[0] for _ in delays), 0.0, 0.0)
    rate = drift[0] if drift is not None and drifting else 0.0
    if spread is None or not differ:
        # The drift is that of one clock, which is restarted at the beginning of each run.
        return Delays(tuple(0.5 * rate * p.run.duration_s for p in runs), rate, 0.0)
    estimated = [d for d in delays if np.isfinite(d.variance)]
    mean = float(
        np.average([d.value for d in estimated], weights=[1.0 / d.variance for d in estimated])
    )
    values = tuple(d.value if np.isfinite(d.variance) else mean for d in delays)
    return Delays(values, rate, spread[0])


def _scans(problem: Problem, solution: Solution, grid: Array) -> Iterator[tuple[Array, Array]]:
    """Yield for each run its squared residuals by delay, shape (len(grid), n), and its times, s.

    The residuals are not whitened: a noise model that describes the error of a delayed force as
    coloured noise would shift this error as well. Runs are processed one at a time to limit the
    memory.
    """
    samples, runs = solution.samples, problem.campaign.prepared
    forces = [fine_force(problem, solution.values, p) for p in runs]
    slopes = [
        np.interp(p.run.time_s, instants, np.gradient(force, instants))
        for p, (instants, force) in zip(runs, forces, strict=True)
    ]
    noise = samples.settings.noise
    residuals = samples.without_deviations(solution.residuals, solution.noise)
    undelayed = _without_delay(problem, solution, residuals, slopes)
    share = independent_share(undelayed, samples.steps_s, noise)
    for i, (p, (instants, force)) in enumerate(zip(runs, forces, strict=True)):
        # An offset or a gain of the run is not a delay.
        reading = p.friction - (solution.residuals[i] - residuals[i])
        counted = samples.counted[i]
        rows = []
        for delay_s in grid:
            shifted = np.interp(p.run.time_s - delay_s, instants, force)
            rows.append(((reading - shifted) * samples.weight[i])[counted])
        e = np.array(rows)
        size = float(np.median(np.abs(e), axis=1).min()) / 0.6745 if e.size else 0.0
        squares = (
            np.minimum((e / size) ** 2, noise.clip_sigma**2) if size > 0.0 else np.zeros_like(e)
        )
        # A sample of coloured residuals carries less information.
        squares *= share
        yield squares, p.run.time_s[counted] - p.run.time_s[0]


def _without_delay(
    problem: Problem, solution: Solution, residuals: list[Array], slopes: list[Array]
) -> list[Array]:
    """Residuals without the contribution of a delay and its growth, one array per run.

    The contribution is removed to first order; otherwise the noise would appear coloured.
    """
    undelayed = []
    for p, residual, slope, counted in zip(
        problem.campaign.prepared, residuals, slopes, solution.samples.counted, strict=True
    ):
        time = p.run.time_s - np.mean(p.run.time_s)
        x = np.stack([slope, slope * time], axis=1) * counted[:, None]
        r = residual * counted
        undelayed.append(r - x @ np.linalg.lstsq(x, r, rcond=1e-10)[0])
    return undelayed


def _grid_estimate(grid: Array, costs: Array, count: int, settings: DelaySettings) -> _Estimate:
    """Mean and variance of a delay under its normalised likelihood on the grid.

    Mean and variance replace the maximum and the curvature, since the sum of squares is
    discontinuous at jumps.
    """
    k = int(np.argmin(costs))
    if count < settings.min_part_samples or not 0 < k < len(grid) - 1:
        return _Estimate()
    likelihood = np.exp(-0.5 * (costs - costs[k]) / max(float(costs[k]) / count, 1.0))
    likelihood /= np.sum(likelihood)
    if likelihood[0] + likelihood[-1] > settings.max_edge_likelihood:
        return _Estimate()
    mean, step = float(np.sum(likelihood * grid)), float(grid[1] - grid[0])
    return _Estimate(mean, float(np.sum(likelihood * (grid - mean) ** 2)) + step**2 / 12.0)


def _drift(grid: Array, squares: Array, time: Array, settings: DelaySettings) -> _Estimate:
    """Estimate the increase of the delay per second from the delays of the parts of a run."""
    last_s = float(time[-1]) if len(time) else 0.0
    edges = np.linspace(0.0, last_s, settings.drift_parts + 1)
    middles, values, weights = [], [], []
    for low, high in itertools.pairwise(edges):
        part = (time >= low) & (time < high)
        delay = _grid_estimate(grid, squares[:, part].sum(axis=1), int(part.sum()), settings)
        if np.isfinite(delay.variance):
            middles.append(0.5 * (low + high))
            values.append(delay.value)
            weights.append(1.0 / delay.variance)
    if len(values) < 2:
        return _Estimate()
    t, w = np.array(middles), np.array(weights)
    t = t - np.sum(w * t) / np.sum(w)
    size = float(np.sum(w * t**2))
    return _Estimate(float(np.sum(w * t * np.array(values))) / size, 1.0 / size)


def _finite(estimates: list[_Estimate]) -> tuple[Array, Array]:
    """Values of the estimates with a finite variance, and their precisions (inverse variances)."""
    finite = [e for e in estimates if np.isfinite(e.variance)]
    return np.array([e.value for e in finite]), 1.0 / np.array([e.variance for e in finite])


def _spread(delays: list[_Estimate], min_runs: int) -> tuple[float, float] | None:
    """Between-run standard deviation of the delays, and its p-value; None if not estimated."""
    values, precisions = _finite(delays)
    if len(values) < min_runs:
        return None
    sd, p_value, _ = spread_between(values, precisions)
    return (sd, p_value) if sd > 0.0 else None


def _common(estimates: list[_Estimate]) -> tuple[float, float] | None:
    """Weighted mean of the estimates over the runs and its p-value; None without estimates."""
    d, w = _finite(estimates)
    if not len(d):
        return None
    mean = float(np.sum(w * d) / np.sum(w))
    spread = float(np.sum(w * (d - mean) ** 2)) / max(len(d) - 1, 1)
    square = mean**2 * float(np.sum(w)) / max(spread, 1.0)
    return mean, float(special.chdtrc(1, 0.5 * square))


@dataclass(frozen=True, eq=False)
class ExactDelay:
    """Time delay of a model, estimated from the jumps of the friction.

    Attributes
    ----------
    values
        All parameter values; the other parameters are conditional on the delay.
    sd_s
        Standard deviation of the delay under its normalised likelihood, s.
    residuals
        Record minus expected reading at these values, N, one array per run.
    """

    values: Array
    sd_s: float
    residuals: list[Array]


def exact_delay(
    problem: Problem, solution: Solution, errors: StandardErrors, values: Array
) -> ExactDelay | None:
    """Estimate the delay parameter of a model by the likelihood of all samples, jumps included.

    Returns None if the model has no free delay parameter.
    """
    if TAU not in problem.names or problem.names.index(TAU) not in problem.open:
        return None
    index = problem.names.index(TAU)
    k = problem.open.index(index)
    steps = [p.step_s for p in problem.campaign.prepared]
    step_s, tau_s = float(np.median(steps)), float(values[index])
    if not errors.sensitive[k] or tau_s < LEAST_STEPS * step_s:
        return None
    sd_s = errors.error(k)
    if not np.isfinite(sd_s):
        return None
    scan = _Scan.of(problem, solution, errors, values, k)
    reach = max(REACH * sd_s, LEAST_REACH_STEPS * step_s)
    delays = np.linspace(-reach, reach, COARSE) + tau_s
    delays = delays[delays > 0.0]
    costs = np.array([scan.cost(delay) for delay in delays])
    best, gap = float(delays[np.argmin(costs)]), 2.0 * reach / (COARSE - 1)
    finer = np.linspace(-gap, gap, FINE)[1:-1] + best
    finer = finer[(finer > 0.0) & ~np.isin(finer, delays)]
    costs = np.append(costs, [scan.cost(delay) for delay in finer])
    delays, first = np.unique(np.append(delays, finer), return_index=True)
    likelihood = np.exp(-0.5 * (costs[first] - np.min(costs))) * np.gradient(delays)
    likelihood /= np.sum(likelihood)
    mean_s = float(np.sum(likelihood * delays))
    variance = np.sum(likelihood * (delays - mean_s) ** 2) + gap**2 / (12.0 * FINE**2)
    sd_s, at_mean = float(np.sqrt(variance)), scan.along(mean_s)
    return ExactDelay(at_mean, sd_s, scan.residuals(at_mean, sd_s))


@dataclass(frozen=True, eq=False)
class _Scan:
    """Likelihood of a delay with the other parameters conditional on it, to first order.

    Attributes
    ----------
    problem, chain
        The model, and its chain evaluated one delay before each sample.
    friction
        Record without the random effects of its run, N, one array per run.
    values
        Parameter values at the solution.
    direction
        Derivative of the search variables with respect to the delay, 1/s.
    noise_rms
        Standard deviation of the noise, N.
    share
        Number of independent samples per sample.
    """

    problem: Problem
    chain: DelayedChain
    friction: list[Array]
    values: Array
    direction: Array
    noise_rms: float
    share: float

    @classmethod
    def of(
        cls, problem: Problem, solution: Solution, errors: StandardErrors, values: Array, k: int
    ) -> _Scan:
        """Prepare the scan of parameter `k`, the delay, at a solution."""
        rig, samples = problem.campaign.rig, solution.samples
        chain = DelayedChain(rig, problem.law, problem.clock, problem.effects, problem.names)
        with np.errstate(invalid="ignore", divide="ignore"):
            direction = errors.correlation[:, k] * errors.sd / errors.sd[k] / errors.scale[k]
        residuals = samples.without_deviations(solution.residuals, solution.noise)
        # The offset or gain of a run must not be taken for a delay.
        friction = [
            p.friction - (a - b)
            for p, a, b in zip(
                problem.campaign.prepared, solution.residuals, residuals, strict=True
            )
        ]
        # A sample of coloured residuals carries less information.
        counted = [r * c for r, c in zip(residuals, samples.counted, strict=True)]
        share = independent_share(counted, samples.steps_s, samples.settings.noise)
        noise_rms = max(samples.rms(residuals), 1e-300)
        direction = np.where(np.isfinite(direction) & errors.sensitive, direction, 0.0)
        return cls(problem, chain, friction, values, direction, noise_rms, share)

    def along(self, delay_s: float) -> Array:
        """Values of all parameters at a delay, s; the others change with it to first order."""
        change = delay_s - float(self.values[self.chain.tau])
        moved = self.problem.encode(self.values) + self.direction * change
        values = self.problem.decode(moved, self.values)
        values[self.chain.tau] = delay_s
        return values

    def cost(self, delay_s: float) -> float:
        """Minus twice the log likelihood of a delay, s."""
        values, total = self.along(delay_s), 0.0
        for p, friction in zip(self.problem.campaign.prepared, self.friction, strict=True):
            reading = self.chain.read(values, p.run, *p.motion_as_read, 0.0)
            before, after = (
                np.minimum(((friction - f) / self.noise_rms) ** 2, CLIPPED**2)
                for f in (reading.before_n, reading.after_n)
            )
            over = reading.over
            mixed = np.minimum(over, 1.0 - over) > 0.5 * np.exp(-0.5 * BLURRED**2)
            mixture = (1.0 - over) * np.exp(-0.5 * before) + over * np.exp(-0.5 * after)
            one_side = np.where(over > 0.5, after, before)
            with np.errstate(divide="ignore"):
                costs = np.where(mixed, -2.0 * np.log(mixture), self.share * one_side)
            total += float(np.sum(costs[p.examined.usable]))
        return total

    def residuals(self, values: Array, sd_s: float) -> list[Array]:
        """Record minus expected reading, N, per run; `sd_s` is the standard error of the delay."""
        residuals = []
        for p in self.problem.campaign.prepared:
            reading = self.chain.read(values, p.run, *p.motion_as_read, sd_s)
            residuals.append(p.friction - reading.mean_n)
        return residuals
