"""Time delays of the forces or of their clock, estimated jointly with the model parameters.

A law adapts to a delayed force. A search for the delay of each run at fixed parameters therefore
keeps what the law has absorbed, and converges slowly. One Gauss-Newton step in the delays of all
runs and all parameters does not have this defect. The part of a delay that a parameter can also
explain is not identifiable, and enlarges the covariance (partitioned regression: Frisch & Waugh
1933).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import ndimage, special

from jbf.estimation.lateness import fine_motion, instants_of
from jbf.estimation.prepared import Prepared
from jbf.estimation.problem import Problem
from jbf.estimation.rows import triangular
from jbf.estimation.solution import Solution

Array = npt.NDArray[np.float64]

DELAY = "time_delay.tau_s"
Clocks = Literal["by run", "shared", "one", "one, delay"]
"""Clock models of the forces.

"by run": each run has its own delay. "shared": all runs have one delay. "one": one clock rate, with
the clock started at each run. "one, delay": the same clock rate and a delay of the instrument.
"""
RANK = 1e-10
"""Fraction of the largest singular value below which a direction is not identifiable.

It is a numerical tolerance.
"""


@dataclass(frozen=True, eq=False)
class LatenessStep:
    """Correction of the time delays of the forces.

    Attributes
    ----------
    late_s
        Additional delay of each run, s, shape (m,); zero where it is not identifiable.
    covariance_s2
        Covariance of the identifiable delays, s^2, from the variance of the residual.
    determined
        Whether each delay is identifiable (`DelaySettings.linear_s`), shape (m,).
    """

    late_s: Array
    covariance_s2: Array
    determined: npt.NDArray[np.bool_]

    @property
    def square(self) -> float:
        """Square of the step in units of its covariance (Wald statistic)."""
        late = self.late_s[self.determined]
        return float(late @ np.linalg.lstsq(self.covariance_s2, late, rcond=RANK)[0])

    @property
    def chance(self) -> float:
        """P-value of the step if every force is compared without an additional delay."""
        count = int(np.sum(self.determined))
        return float(special.chdtrc(count, self.square)) if count else 1.0

    def differ_chance(self, late_s: Array) -> float:
        """P-value of the differences between the total delays of the runs.

        Parameters
        ----------
        late_s
            Delays of the runs applied before this step, s, shape (m,).
        """
        count = int(np.sum(self.determined))
        if count < 2:
            return 1.0
        inverse = np.linalg.pinv(self.covariance_s2, rcond=RANK, hermitian=True)
        late = (late_s + self.late_s)[self.determined]
        late -= np.sum(inverse @ late) / np.sum(inverse)
        return float(special.chdtrc(count - 1, float(late @ inverse @ late)))

    def mean_s(self, late_s: Array) -> float:
        """Mean of the identifiable delays, weighted by their inverse variance, s."""
        if not np.any(self.determined):
            return 0.0
        return float(np.average(late_s[self.determined], weights=1.0 / np.diag(self.covariance_s2)))


@dataclass(frozen=True)
class DriftStep:
    """Correction of the drift of the force clock.

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
        """Square of the drift in units of its variance (Wald statistic)."""
        return self.drift**2 / self.variance


def lateness_step(problem: Problem, solution: Solution) -> LatenessStep:
    """Gauss-Newton step in the time delay of each run and the parameters of the model.

    A delay parameter that all runs share is excluded, since it is part of each run's delay.
    """
    own = [k for k, i in enumerate(problem.open) if problem.names[i] != DELAY]
    late, of_late = _step(problem, solution, own, "by run")
    linear_s = problem.campaign.settings.delays.linear_s
    # An exact fit gives no variance.
    determined = (np.diag(of_late) > 0.0) & (np.diag(of_late) < linear_s**2)
    return LatenessStep(
        np.where(determined, late, 0.0), of_late[np.ix_(determined, determined)], determined
    )


def delay_step(problem: Problem, solution: Solution) -> tuple[float, float]:
    """Gauss-Newton step in a time delay of the force that all runs share, and all parameters.

    Returns
    -------
    tuple[float, float]
        Additional delay of the forces, s, and its standard error, s; infinite if the delay is not
        identifiable.
    """
    late, of_late = _step(problem, solution, list(range(len(problem.open))), "shared")
    sd = float(np.sqrt(max(of_late[0, 0], 0.0)))
    return (float(late[0]), sd) if sd > 0.0 else (0.0, np.inf)


def drift_step(problem: Problem, solution: Solution, beside_delay: bool = False) -> DriftStep:
    """Gauss-Newton step in the drift of a clock started with each run, and all parameters.

    Parameters
    ----------
    beside_delay
        Whether all runs may additionally have a common delay of the instrument.
    """
    clocks: Clocks = "one, delay" if beside_delay and DELAY not in problem.names else "one"
    late, of_late = _step(problem, solution, list(range(len(problem.open))), clocks)
    longest_s = max(p.run.duration_s for p in problem.campaign.prepared)
    linear_s = problem.campaign.settings.delays.linear_s
    determined = 0.0 < of_late[0, 0] * longest_s**2 < linear_s**2
    return DriftStep(float(late[0]), float(of_late[0, 0])) if determined else DriftStep(0.0, np.inf)


def delay_slope(problem: Problem, values: Array, prepared: Prepared) -> Array:
    """Derivative of the prediction of a run with respect to a delay of the force, shape (n,)."""
    instants = instants_of(prepared)
    force = problem.chain.predict(values, [fine_motion(prepared)])[0]
    return np.asarray(-np.interp(prepared.run.time_s, instants, np.gradient(force, instants)))


def _step(
    problem: Problem, solution: Solution, own: Sequence[int], clocks: Clocks
) -> tuple[Array, Array]:
    """Step in the delays of a clock model, joint with the parameters, and its covariance."""
    width = len(own)
    later = {
        "by run": len(problem.campaign.prepared),
        "shared": 1,
        "one": 1,
        "one, delay": 2,
    }[clocks]
    rows, right, samples = [], [], 0
    for i, (r, j, count) in enumerate(_rows(problem, solution, own, clocks)):
        wide = np.zeros((len(r), width + later))
        wide[:, :width] = j[:, :width]
        first = width + i if clocks == "by run" else width
        wide[:, first : first + j.shape[1] - width] = j[:, width:]
        rows.append(wide)
        right.append(r)
        samples += count
    x, y = np.concatenate(rows), np.concatenate(right)
    # Scale the rows so that the squares of very large forces do not overflow.
    largest = float(max(np.max(np.abs(x), initial=0.0), np.max(np.abs(y), initial=0.0)))
    if largest > 0.0:
        x, y = x / largest, y / largest
    scale = np.sqrt(np.sum(x**2, axis=0))
    tells = scale[width:] > 0.0
    scale[scale == 0.0] = 1.0
    step, *_ = np.linalg.lstsq(x / scale, y, rcond=RANK)
    left = y - x @ (step / scale)
    inverse = np.linalg.pinv(x / scale, rcond=RANK)
    covariance = float(left @ left) / max(samples, 1) * (inverse @ inverse.T)
    with np.errstate(over="ignore"):
        covariance /= np.outer(scale, scale)  # infinite where a clock is not identifiable
    of_later = covariance[width:, width:]
    return (step / scale)[width:], np.where(np.outer(tells, tells), of_later, 0.0)


def _rows(
    problem: Problem, solution: Solution, by: Sequence[int], clocks: Clocks
) -> Iterator[tuple[Array, Array, int]]:
    """Yield the innovations and derivatives of each run in reduced rows, and the sample count.

    The derivatives are with respect to the given parameters and, last, the delays of the clock
    model.
    """
    samples = solution.samples
    for i, p in enumerate(problem.campaign.prepared):
        slope = delay_slope(problem, solution.values, p)
        since_start = p.run.time_s - p.run.time_s[0]
        later = {
            "by run": [slope],
            "shared": [slope],
            "one": [slope * since_start],
            "one, delay": [slope * since_start, slope],
        }[clocks]
        apart = int(np.ceil(problem.campaign.settings.delays.linear_s / p.step_s))
        far = ~ndimage.binary_dilation(~p.slides, iterations=apart)
        own = samples.only([i]).within([far])
        derivatives = np.column_stack([solution.jacobian[i][:, by], *later])
        r, j = own.stacked([solution.residuals[i]], [derivatives], solution.noise)
        count = len(r)
        # The residual remains a separate row where it is longer than its derivatives.
        r, j = triangular(r, j)
        yield r, j, count
