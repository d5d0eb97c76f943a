"""How late the force of each run is, or its clock, estimated together with the model that tells it.

A law gives way to a late force: on a search for where each run's squares are least it keeps what it
has given, and moves on by and by. One step of Gauss and Newton in the lateness of every run and all
parameters at once does not: what a parameter can say as well is no lateness, and the covariance
tells how much of it that is (partitioned regression: Frisch & Waugh 1933).
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
"""By which clocks forces were read: by one of each run's own, with one delay in all runs, or by one
that was started with each run, where the instrument may delay them all besides."""
LINEAR_S = 8e-3
"""A force changes as its slope says over a shift of so much; no sample nearer a reversal tells
it."""
RANK = 1e-10
"""Share of the largest singular value below which a direction says nothing."""


@dataclass(frozen=True, eq=False)
class LatenessStep:
    """By how much later forces are than they are compared.

    Attributes
    ----------
    late_s
        Of each run, s, shape (m,); zero of one that cannot tell it.
    covariance_s2
        Of those that can, s^2, as the residual's spread has it.
    told
        Which runs can, to within `LINEAR_S`, shape (m,).
    """

    late_s: Array
    covariance_s2: Array
    told: npt.NDArray[np.bool_]

    @property
    def square(self) -> float:
        """Its square, in units of its covariance (Wald's statistic)."""
        late = self.late_s[self.told]
        return float(late @ np.linalg.lstsq(self.covariance_s2, late, rcond=RANK)[0])

    @property
    def chance(self) -> float:
        """Probability of so much where every force is compared on time."""
        count = int(np.sum(self.told))
        return float(special.chdtrc(count, self.square)) if count else 1.0

    def differ_chance(self, late_s: Array) -> float:
        """Probability that runs that are late by so much, as they were compared until this step,
        differ so much by chance."""
        count = int(np.sum(self.told))
        if count < 2:
            return 1.0
        inverse = np.linalg.pinv(self.covariance_s2, rcond=RANK, hermitian=True)
        late = (late_s + self.late_s)[self.told]
        late -= np.sum(inverse @ late) / np.sum(inverse)
        return float(special.chdtrc(count - 1, float(late @ inverse @ late)))

    def mean_s(self, late_s: Array) -> float:
        """The mean lateness of the runs that tell theirs, by how surely they do, s."""
        if not np.any(self.told):
            return 0.0
        return float(np.average(late_s[self.told], weights=1.0 / np.diag(self.covariance_s2)))


@dataclass(frozen=True)
class DriftStep:
    """By how much slower than it is taken for the clock of the forces runs.

    Attributes
    ----------
    drift
        By how much later forces get in a second.
    variance
        Of that, as the residual's spread has it; infinite where it cannot be told.
    """

    drift: float
    variance: float

    @property
    def square(self) -> float:
        """Its square, in units of its variance (Wald's statistic)."""
        return self.drift**2 / self.variance


def lateness_step(problem: Problem, solution: Solution) -> LatenessStep:
    """A step of Gauss and Newton in each run's lateness and all parameters of the model, but for a
    delay that all runs share: that is a part of each one's."""
    own = [k for k, i in enumerate(problem.open) if problem.names[i] != DELAY]
    late, of_late = _step(problem, solution, own, "by run")
    # Where nothing is left, nothing says how surely.
    told = (np.diag(of_late) > 0.0) & (np.diag(of_late) < LINEAR_S**2)
    return LatenessStep(np.where(told, late, 0.0), of_late[np.ix_(told, told)], told)


def delay_step(problem: Problem, solution: Solution) -> tuple[float, float]:
    """A step of Gauss and Newton in a delay of the force that all runs share, and all parameters.

    Returns
    -------
    tuple[float, float]
        By how much later the forces are than they are compared, s, and its standard error, s;
        infinite where the runs do not tell it.
    """
    late, of_late = _step(problem, solution, list(range(len(problem.open))), "shared")
    sd = float(np.sqrt(max(of_late[0, 0], 0.0)))
    return (float(late[0]), sd) if sd > 0.0 else (0.0, np.inf)


def drift_step(problem: Problem, solution: Solution, beside_delay: bool = False) -> DriftStep:
    """A step of Gauss and Newton in the drift of one clock that was started with each run, and all
    parameters of the model.

    Parameters
    ----------
    beside_delay
        Whether all runs may be late by a time of the instrument's besides.
    """
    clocks: Clocks = "one, delay" if beside_delay and DELAY not in problem.names else "one"
    late, of_late = _step(problem, solution, list(range(len(problem.open))), clocks)
    longest_s = max(p.run.duration_s for p in problem.campaign.prepared)
    told = 0.0 < of_late[0, 0] * longest_s**2 < LINEAR_S**2
    return DriftStep(float(late[0]), float(of_late[0, 0])) if told else DriftStep(0.0, np.inf)


def delay_slope(problem: Problem, values: Array, prepared: Prepared) -> Array:
    """Derivative of the prediction of a run by a delay of the force, shape (n,)."""
    instants = instants_of(prepared)
    force = problem.chain.predict(values, [fine_motion(prepared)])[0]
    return np.asarray(-np.interp(prepared.run.time_s, instants, np.gradient(force, instants)))


def _step(
    problem: Problem, solution: Solution, own: Sequence[int], clocks: Clocks
) -> tuple[Array, Array]:
    """The step in what clocks say of lateness, beside these parameters, and its covariance."""
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
    # Forces of any size: their squares must not overflow.
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
        covariance /= np.outer(scale, scale)  # infinite where a clock is not told
    of_later = covariance[width:, width:]
    return (step / scale)[width:], np.where(np.outer(tells, tells), of_later, 0.0)


def _rows(
    problem: Problem, solution: Solution, by: Sequence[int], clocks: Clocks
) -> Iterator[tuple[Array, Array, int]]:
    """Of each run the innovations, their derivatives by these parameters and, last, by its
    lateness as clocks say it, in few rows; and how many samples there were."""
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
        apart = int(np.ceil(LINEAR_S / p.step_s))
        far = ~ndimage.binary_dilation(~p.slides, iterations=apart)
        own = samples.only([i]).within([far])
        derivatives = np.column_stack([solution.jacobian[i][:, by], *later])
        r, j = own.stacked([solution.residuals[i]], [derivatives], solution.noise)
        count = len(r)
        # The residual stays a row of its own where it is longer than its derivatives.
        r, j = triangular(r, j)
        yield r, j, count
