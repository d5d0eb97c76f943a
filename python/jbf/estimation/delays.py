"""Time delays of the force channel, estimated jointly with the parameters of a model.

A delay that differs between runs, or a clock with a wrong rate, is a recording artefact and not an
effect. The force is then compared with the motion at the time at which the force was read. The
estimates of a law are biased by a delayed force. A search for the delay of each run at fixed
parameters (`delay_scan`) therefore underestimates the delay and converges slowly. A joint
Gauss-Newton step in the delays of all runs and all parameters avoids this bias.

Notes
-----
The part of a delay that a parameter can also explain is not identifiable. It enlarges the
covariance of the step (partitioned regression: Frisch & Waugh 1933).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import ndimage, special

from jbf.arrays import Array
from jbf.estimation.least_squares import triangular
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.solution import Solution
from jbf.models.chain import core_motion
from jbf.models.delayed_reading import TAU

Clocks = Literal["by run", "drift", "drift and delay"]
"""Clock models of the forces.

"by run": each run has its own delay. "drift": one clock rate, with the clock started at each run.
"drift and delay": the same clock rate and a delay of the instrument.
"""
FINE_S = 2.5e-3
"""Largest interval between the times at which the model's force is computed, s."""
RANK = 1e-10
"""Fraction of the largest singular value below which a direction is not identifiable."""


@dataclass(frozen=True, eq=False)
class DelayStep:
    """Gauss-Newton correction of the time delays of the forces.

    Attributes
    ----------
    delays_s
        Additional delay of each run, s, shape (m,); zero where it is not identifiable.
    covariance_s2
        Covariance of the identifiable delays, s^2, from the variance of the residual.
    identifiable
        Whether each delay is identifiable (`DelaySettings.linear_s`), shape (m,).
    """

    delays_s: Array
    covariance_s2: Array
    identifiable: npt.NDArray[np.bool_]

    @property
    def square(self) -> float:
        """Wald statistic of the step: its square relative to its covariance."""
        delays = self.delays_s[self.identifiable]
        return float(delays @ np.linalg.lstsq(self.covariance_s2, delays, rcond=RANK)[0])

    @property
    def p_value(self) -> float:
        """p-value of the step under the null hypothesis that no run has an additional delay."""
        count = int(np.sum(self.identifiable))
        return float(special.chdtrc(count, self.square)) if count else 1.0

    def differences_p_value(self, applied_s: Array) -> float:
        """p-value of the differences between the total delays of the runs.

        `applied_s` has the delays of the runs applied before this step, s, shape (m,).
        """
        count = int(np.sum(self.identifiable))
        if count < 2:
            return 1.0
        inverse = np.linalg.pinv(self.covariance_s2, rcond=RANK, hermitian=True)
        total = (applied_s + self.delays_s)[self.identifiable]
        total -= np.sum(inverse @ total) / np.sum(inverse)
        return float(special.chdtrc(count - 1, float(total @ inverse @ total)))

    def mean_s(self, delays_s: Array) -> float:
        """Mean of the identifiable delays in `delays_s`, weighted by inverse variance, s."""
        if not np.any(self.identifiable):
            return 0.0
        weights = 1.0 / np.diag(self.covariance_s2)
        return float(np.average(delays_s[self.identifiable], weights=weights))


@dataclass(frozen=True)
class DriftStep:
    """Gauss-Newton correction of the drift of the force clock.

    Attributes
    ----------
    drift
        Increase of the delay of the forces per second.
    variance
        Variance of the drift from the variance of the residual; infinite if it is not identifiable.
    """

    drift: float
    variance: float

    @property
    def square(self) -> float:
        """Wald statistic of the drift: its square relative to its variance."""
        return self.drift**2 / self.variance


def run_delay_step(problem: Problem, solution: Solution) -> DelayStep:
    """Gauss-Newton step in the time delay of each run and the parameters of the model.

    A delay parameter that all runs share is excluded, since it is part of each run's delay.
    """
    columns = [k for k, i in enumerate(problem.open) if problem.names[i] != TAU]
    delays, covariance = _step(problem, solution, columns, "by run")
    linear_s = problem.campaign.settings.delays.linear_s
    # The variance of the residual of an exact fit is zero.
    identifiable = (np.diag(covariance) > 0.0) & (np.diag(covariance) < linear_s**2)
    return DelayStep(
        np.where(identifiable, delays, 0.0),
        covariance[np.ix_(identifiable, identifiable)],
        identifiable,
    )


def drift_step(problem: Problem, solution: Solution, with_delay: bool = False) -> DriftStep:
    """Gauss-Newton step in the drift of a clock that starts with each run, and all parameters.

    With `with_delay`, all runs may additionally have a common delay of the instrument.
    """
    clocks: Clocks = "drift and delay" if with_delay and TAU not in problem.names else "drift"
    step, covariance = _step(problem, solution, range(len(problem.open)), clocks)
    longest_s = max(p.run.duration_s for p in problem.campaign.prepared)
    linear_s = problem.campaign.settings.delays.linear_s
    drift, variance = float(step[0]), float(covariance[0, 0])
    identifiable = 0.0 < variance * longest_s**2 < linear_s**2
    return DriftStep(drift, variance) if identifiable else DriftStep(0.0, np.inf)


def fine_force(problem: Problem, values: Array, p: Prepared) -> tuple[Array, Array]:
    """Times of a run at most `FINE_S` apart, s, and the predicted force at these times, N.

    The times divide the sampling intervals of the run.
    """
    count = max(int(np.ceil(p.step_s / FINE_S)), 1)
    samples = np.arange(len(p.run), dtype=np.float64)
    place = np.linspace(0.0, len(p.run) - 1.0, count * (len(p.run) - 1) + 1)
    instants = np.interp(place, samples, p.run.time_s).astype(np.float64)
    run = p.run.at(instants, np.interp(instants, p.run.time_s, p.friction))
    motion = core_motion(p.rig, run, p.motion.at(p.run.time_s, instants))
    return instants, problem.chain.predict(values, [motion])[0]


def delay_slope(problem: Problem, values: Array, prepared: Prepared) -> Array:
    """Derivative of the prediction with respect to a delay of the force, N/s, shape (n,)."""
    instants, force = fine_force(problem, values, prepared)
    return np.asarray(-np.interp(prepared.run.time_s, instants, np.gradient(force, instants)))


def _step(
    problem: Problem, solution: Solution, columns: Sequence[int], clocks: Clocks
) -> tuple[Array, Array]:
    """Gauss-Newton step in the delays of a clock model and the parameters, with its covariance.

    `columns` selects the parameters among the free ones.
    """
    width, runs = len(columns), len(problem.campaign.prepared)
    rows, right, samples = [], [], 0
    for i, (r, j, count) in enumerate(_rows(problem, solution, columns, clocks)):
        x = j
        if clocks == "by run":
            x = np.zeros((len(r), width + runs))
            x[:, :width], x[:, width + i] = j[:, :width], j[:, width]
        rows.append(x)
        right.append(r)
        samples += count
    x, y = np.concatenate(rows), np.concatenate(right)
    # Scale the rows so that the squares of very large forces do not overflow.
    largest = float(max(np.max(np.abs(x), initial=0.0), np.max(np.abs(y), initial=0.0)))
    if largest > 0.0:
        x, y = x / largest, y / largest
    scale = np.sqrt(np.sum(x**2, axis=0))
    sensitive = scale[width:] > 0.0
    scale[scale == 0.0] = 1.0
    step, *_ = np.linalg.lstsq(x / scale, y, rcond=RANK)
    residual = y - x @ (step / scale)
    inverse = np.linalg.pinv(x / scale, rcond=RANK)
    covariance = float(residual @ residual) / max(samples, 1) * (inverse @ inverse.T)
    with np.errstate(over="ignore"):
        covariance /= np.outer(scale, scale)  # infinite where a clock is not identifiable
    covariance = np.where(np.outer(sensitive, sensitive), covariance[width:, width:], 0.0)
    return (step / scale)[width:], covariance


def _rows(
    problem: Problem, solution: Solution, columns: Sequence[int], clocks: Clocks
) -> Iterator[tuple[Array, Array, int]]:
    """Yield innovations and their Jacobian of each run in triangular form, and the sample count.

    The columns of the Jacobian are derivatives with respect to the selected parameters and, last,
    the delays of the clock model.
    """
    for i, p in enumerate(problem.campaign.prepared):
        slope = delay_slope(problem, solution.values, p)
        drift = slope * (p.run.time_s - p.run.time_s[0])
        by_clock = {
            "by run": [slope],
            "drift": [drift],
            "drift and delay": [drift, slope],
        }[clocks]
        reach = int(np.ceil(problem.campaign.settings.delays.linear_s / p.step_s))
        far = ~ndimage.binary_dilation(~p.motion.slides, iterations=reach)
        samples = solution.samples.only([i]).within([far])
        derivatives = np.column_stack([solution.jacobian[i][:, list(columns)], *by_clock])
        r, j = samples.stacked([solution.residuals[i]], [derivatives], solution.noise)
        # The last row is the part of the residual that the derivatives do not explain.
        yield *triangular(r, j), len(r)
