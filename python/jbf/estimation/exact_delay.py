"""Exact time delay of a record, determined by its jumps.

The search interpolates the delayed force linearly between samples. The likelihood then has a
slope that a search can follow, but samples next to a jump have little weight. These samples
determine the delay best: each shows whether it was read before or after a reversal. After the
search, the model is therefore evaluated one delay before each sample, and the likelihood of the
delay is scanned. A sample close to a reversal is a mixture of both sides of the jump. The other
samples follow the delay along the valley of the objective that the search found.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from jbf.estimation.likelihood import independent_share
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.estimation.spread import Spread
from jbf.models.delayed_reading import TAU, DelayedChain

Array = npt.NDArray[np.float64]

LEAST_STEPS = 0.05
"""Smallest delay, in sampling intervals, that moves a jump from one sample to another.

It enters no verdict.
"""
REACH = 5.0
"""Range of the scan to either side, in standard errors of the search. It bounds a search only."""
LEAST_REACH_STEPS = 0.2
"""Minimum range of the scan to either side, in sampling intervals. It bounds a search only."""
COARSE, FINE = 31, 17
"""Number of delays in the first scan, and in a second one around the most likely delay.

It is a numerical resolution.
"""
CLIPPED = 5.0
"""Limit of the contribution of a residual, in standard deviations. It enters no verdict."""
BLURRED = 3.5
"""Distance from a jump within which its side is uncertain, in standard errors of its time.

It enters no verdict.
"""


@dataclass(frozen=True, eq=False)
class ExactDelay:
    """Time delay determined by the jumps.

    Attributes
    ----------
    values
        All parameter values; the others follow the delay.
    sd_s
        Standard deviation of the likelihood of the delay, s, which no curvature gives.
    residuals
        Record minus expected reading at these values, N, one array a run.
    """

    values: Array
    sd_s: float
    residuals: list[Array]


def exact_delay(
    problem: Problem, solution: Solution, spread: Spread, values: Array
) -> ExactDelay | None:
    """Estimate the delay by the likelihood of all samples; None if the model has no free delay."""
    if TAU not in problem.names or problem.names.index(TAU) not in problem.open:
        return None
    which = problem.names.index(TAU)
    k = problem.open.index(which)
    steps = [p.step_s for p in problem.campaign.prepared]
    step_s, tau_s = float(np.median(steps)), float(values[which])
    if not spread.moved[k] or tau_s < LEAST_STEPS * step_s:
        return None
    sd_s = spread.error(k)
    if not np.isfinite(sd_s):
        return None
    scan = _Scan.of(problem, solution, spread, values, k)
    reach = max(REACH * sd_s, LEAST_REACH_STEPS * step_s)
    delays = np.linspace(-reach, reach, COARSE) + tau_s
    delays = delays[delays > 0.0]
    costs = np.array([scan.cost(delay) for delay in delays])
    best, gap = float(delays[np.argmin(costs)]), 2.0 * reach / (COARSE - 1)
    finer = np.linspace(-gap, gap, FINE)[1:-1] + best
    finer = finer[(finer > 0.0) & ~np.isin(finer, delays)]
    costs = np.append(costs, [scan.cost(delay) for delay in finer])
    delays, first = np.unique(np.append(delays, finer), return_index=True)
    likely = np.exp(-0.5 * (costs[first] - np.min(costs))) * np.gradient(delays)
    likely /= np.sum(likely)
    mean = float(np.sum(likely * delays))
    spread_s = float(np.sqrt(np.sum(likely * (delays - mean) ** 2) + gap**2 / (12.0 * FINE**2)))
    found = scan.along(mean)
    return ExactDelay(found, spread_s, scan.residuals(found, spread_s))


@dataclass(frozen=True, eq=False)
class _Scan:
    """Likelihood of a delay with the other parameters following it."""

    problem: Problem
    chain: DelayedChain
    friction: list[Array]
    values: Array
    way: Array
    """Derivative of the search variables with respect to the delay, 1/s."""
    noise_rms: float
    share: float

    @classmethod
    def of(
        cls, problem: Problem, solution: Solution, spread: Spread, values: Array, k: int
    ) -> _Scan:
        rig, samples = problem.campaign.rig, solution.samples
        chain = DelayedChain(rig, problem.law, problem.clock, problem.effects, problem.names)
        with np.errstate(invalid="ignore", divide="ignore"):
            way = spread.correlation[:, k] * spread.sd / spread.sd[k] / spread.scale[k]
        left = samples.without_deviations(solution.residuals, solution.noise)
        # A run's own zero or gain must not be taken for a delay.
        friction = [
            p.friction - (r - own)
            for p, r, own in zip(problem.campaign.prepared, solution.residuals, left, strict=True)
        ]
        # A sample of coloured residuals carries less information.
        counted = [r * c for r, c in zip(left, samples.counted, strict=True)]
        share = independent_share(counted, samples.steps_s, samples.settings.noise)
        noise_rms = max(samples.rms(left), 1e-300)
        way = np.where(np.isfinite(way) & spread.moved, way, 0.0)
        return cls(problem, chain, friction, values, way, noise_rms, share)

    def along(self, delay_s: float) -> Array:
        """Values of all parameters for a given delay."""
        late = delay_s - float(self.values[self.chain.tau])
        moved = self.problem.encode(self.values) + self.way * late
        there = self.problem.decode(moved, self.values)
        there[self.chain.tau] = delay_s
        return there

    def cost(self, delay_s: float) -> float:
        """Minus twice the log likelihood."""
        values, total = self.along(delay_s), 0.0
        for p, friction in zip(self.problem.campaign.prepared, self.friction, strict=True):
            reading = self.chain.read(values, p.run, *p.motion_as_read, 0.0)
            far = [
                np.minimum(((friction - f) / self.noise_rms) ** 2, CLIPPED**2)
                for f in (reading.before_n, reading.after_n)
            ]
            over = reading.over
            doubt = np.minimum(over, 1.0 - over) > 0.5 * np.exp(-0.5 * BLURRED**2)
            near = (1.0 - over) * np.exp(-0.5 * far[0]) + over * np.exp(-0.5 * far[1])
            sure = np.where(over > 0.5, far[1], far[0])
            with np.errstate(divide="ignore"):
                each = np.where(doubt, -2.0 * np.log(near), self.share * sure)
            total += float(np.sum(each[p.examined.usable]))
        return total

    def residuals(self, values: Array, sd_s: float) -> list[Array]:
        """Record minus expected reading, N."""
        left = []
        for p in self.problem.campaign.prepared:
            reading = self.chain.read(values, p.run, *p.motion_as_read, sd_s)
            left.append(p.friction - reading.mean_n)
        return left
