"""Time delay of the force channel of each run relative to its motion, estimated with a model.

A delay that differs between runs, or a clock with a wrong rate, is a recording artefact and not an
effect. The force is then compared with the motion at the time at which it was read. The delay of a
run minimises the squared residuals as the model's force is shifted in time. Parts of a run show
whether the delay grows.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import special

from jbf.estimation.likelihood import independent_share
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.random_effect import spread_between
from jbf.estimation.settings import DelaySettings
from jbf.estimation.solution import Solution
from jbf.models.chain import core_motion
from jbf.models.driven import Driven

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

FINE_S = 2.5e-3
"""Largest interval between the times at which the model's force is computed, s.

It is a numerical resolution.
"""


@dataclass(frozen=True)
class Lateness:
    """Time delays of the force.

    Attributes
    ----------
    late_s
        Delay in the middle of each run, s.
    drift
        Increase of the delay per second.
    spread_s
        Standard deviation of the delay between runs, s; zero if the runs do not differ.
    """

    late_s: tuple[float, ...]
    drift: float
    spread_s: float


@dataclass(frozen=True)
class _Place:
    """An estimate and its variance; without an estimate the variance is infinite."""

    value: float
    variance: float


def lateness(problem: Problem, solution: Solution, look: int, chance: float) -> Lateness | None:
    """Estimate how the delays of the runs differ; None if they do not differ significantly.

    All samples are used, including those next to reversals. These determine a delay of less than
    one sample if the friction is smooth in time; otherwise they determine it in steps. A delay
    common to all runs may be that of the instrument, which is an effect. A force that is early in
    all runs is a recording artefact.

    Parameters
    ----------
    look
        0 for the first scan; 1 if the runs were shifted before.
    chance
        Significance level for differences between runs and for a common drift.
    """
    settings = problem.campaign.settings.delays
    ranges = settings.search_ranges_s
    reach, step = ranges[min(look, len(ranges) - 1)]
    grid = np.arange(-reach, reach + 0.5 * step, step)
    whole, drifts = [], []
    for squares, time in _scans(problem, solution, grid):
        whole.append(_place(grid, squares.sum(axis=1), squares.shape[1], settings))
        drifts.append(_drift(grid, squares, time, settings))
    runs, least = problem.campaign.prepared, problem.campaign.settings.variance.min_runs
    by_run, drift = _spread(whole, least), _common(drifts)
    differ = by_run is not None and by_run[1] < chance
    grows = drift is not None and drift[1] < chance
    if not differ and not grows:
        early = _common(whole)
        if early is None or early[0] >= 0.0 or early[1] >= chance:
            return None
        return Lateness(tuple(early[0] for _ in whole), 0.0, 0.0)
    share = drift[0] if drift is not None and grows else 0.0
    if by_run is None or not differ:
        # One clock, started with each run.
        return Lateness(tuple(0.5 * share * p.run.duration_s for p in runs), share, 0.0)
    known = [w for w in whole if np.isfinite(w.variance)]
    usual = float(np.average([w.value for w in known], weights=[1.0 / w.variance for w in known]))
    late = tuple(w.value if np.isfinite(w.variance) else usual for w in whole)
    return Lateness(late, share, by_run[0])


def _scans(problem: Problem, solution: Solution, grid: Array) -> Iterator[tuple[Array, Array]]:
    """Yield the squared residuals of each run by delay, (len(grid), n), and the sample times.

    The residuals are not whitened. A filter that describes the error of a delayed force as coloured
    noise would shift that error as well. Runs are processed one at a time, because a recording of
    days would fill the memory.
    """
    samples, runs = solution.samples, problem.campaign.prepared
    forces = [problem.chain.predict(solution.values, [fine_motion(p)])[0] for p in runs]
    slopes = []
    for p, force in zip(runs, forces, strict=True):
        instants = instants_of(p)
        slopes.append(np.interp(p.run.time_s, instants, np.gradient(force, instants)))
    noise = samples.settings.noise
    share = independent_share(_on_time(problem, solution, slopes), samples.steps_s, noise)
    left_over = samples.without_deviations(solution.residuals, solution.noise)
    for i, (p, force) in enumerate(zip(runs, forces, strict=True)):
        instants = instants_of(p)
        # An offset or a gain of the run is not a delay.
        read = p.friction - (solution.residuals[i] - left_over[i])
        kept = samples.counted[i]
        rows = []
        for late in grid:
            shifted = np.interp(p.run.time_s - late, instants, force)
            rows.append(((read - shifted) * samples.weight[i])[kept])
        e = np.array(rows)
        size = float(np.median(np.abs(e), axis=1).min()) / 0.6745 if e.size else 0.0
        squares = (
            np.minimum((e / size) ** 2, noise.clip_sigma**2) if size > 0.0 else np.zeros_like(e)
        )
        # A sample of coloured residuals carries less information.
        squares *= share
        yield squares, p.run.time_s[kept] - p.run.time_s[0]


def _on_time(problem: Problem, solution: Solution, slopes: list[Array]) -> list[Array]:
    """Residuals without the contribution of a delay and its growth, one array a run.

    The contribution is removed to first order; otherwise the noise would appear coloured.
    """
    samples, left = solution.samples, []
    left_over = samples.without_deviations(solution.residuals, solution.noise)
    for p, residual, slope, counted in zip(
        problem.campaign.prepared, left_over, slopes, samples.counted, strict=True
    ):
        time = p.run.time_s - np.mean(p.run.time_s)
        x = np.stack([slope, slope * time], axis=1) * counted[:, None]
        r = residual * counted
        left.append(r - x @ np.linalg.lstsq(x, r, rcond=1e-10)[0])
    return left


def instants_of(p: Prepared) -> Array:
    """Times of a run that are close enough for an interpolated shift, s."""
    times = max(int(np.ceil(p.step_s / FINE_S)), 1)
    samples = np.arange(len(p.run), dtype=np.float64)
    place = np.linspace(0.0, len(p.run) - 1.0, times * (len(p.run) - 1) + 1)
    found: Array = np.interp(place, samples, p.run.time_s)
    return found


def fine_motion(p: Prepared) -> Driven:
    """Motion of a run at the times of `instants_of`."""
    instants = instants_of(p)
    run = p.run.at(instants, np.interp(instants, p.run.time_s, p.friction))
    return core_motion(p.rig, run, p.motion.at(p.run.time_s, instants))


def _place(grid: Array, costs: Array, count: int, settings: DelaySettings) -> _Place:
    """Mean and variance of the likelihood on the grid.

    They replace the curvature, since squares change in steps next to jumps.
    """
    k = int(np.argmin(costs))
    if count < settings.min_part_samples or not 0 < k < len(grid) - 1:
        return _Place(0.0, np.inf)
    likely = np.exp(-0.5 * (costs - costs[k]) / max(float(costs[k]) / count, 1.0))
    likely /= np.sum(likely)
    if likely[0] + likely[-1] > settings.max_edge_likelihood:
        return _Place(0.0, np.inf)
    mean, step = float(np.sum(likely * grid)), float(grid[1] - grid[0])
    return _Place(mean, float(np.sum(likely * (grid - mean) ** 2)) + step**2 / 12.0)


def _drift(grid: Array, squares: Array, time: Array, settings: DelaySettings) -> _Place:
    """Slope of the delay over the parts of a run."""
    last_s = float(time[-1]) if len(time) else 0.0
    edges = np.linspace(0.0, last_s, settings.drift_parts + 1)
    middles, values, weights = [], [], []
    for low, high in itertools.pairwise(edges):
        here = (time >= low) & (time < high)
        place = _place(grid, squares[:, here].sum(axis=1), int(here.sum()), settings)
        if np.isfinite(place.variance):
            middles.append(0.5 * (low + high))
            values.append(place.value)
            weights.append(1.0 / place.variance)
    if len(values) < 2:
        return _Place(0.0, np.inf)
    t, w = np.array(middles), np.array(weights)
    t = t - np.sum(w * t) / np.sum(w)
    size = float(np.sum(w * t**2))
    return _Place(float(np.sum(w * t * np.array(values))) / size, 1.0 / size)


def _spread(places: list[_Place], min_runs: int) -> tuple[float, float] | None:
    """Standard deviation between runs, and its p-value."""
    known = [p for p in places if np.isfinite(p.variance)]
    if len(known) < min_runs:
        return None
    values = np.array([p.value for p in known])
    precisions = 1.0 / np.array([p.variance for p in known])
    sd, chance, _ = spread_between(values, precisions)
    return (sd, chance) if sd > 0.0 else None


def _common(drifts: list[_Place]) -> tuple[float, float] | None:
    """Weighted mean over the runs, and its p-value."""
    known = [p for p in drifts if np.isfinite(p.variance)]
    if not known:
        return None
    d = np.array([p.value for p in known])
    w = 1.0 / np.array([p.variance for p in known])
    mean = float(np.sum(w * d) / np.sum(w))
    spread = float(np.sum(w * (d - mean) ** 2)) / max(len(d) - 1, 1)
    square = mean**2 * float(np.sum(w)) / max(spread, 1.0)
    return mean, float(special.chdtrc(1, 0.5 * square))
