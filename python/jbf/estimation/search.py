"""Least squares on innovations from one starting point, within bounds.

Searches of one problem share their evaluations. A search that starts at the lowest point of the
others does not evaluate it again, and a search ends if it reaches a point of another search.
`other_peaks` finds further starting points for a parameter, such as a frequency, whose likelihood
has several maxima.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from jbf.arrays import Array
from jbf.estimation.least_squares import triangular
from jbf.estimation.levenberg_marquardt import SearchResult, minimise
from jbf.estimation.noise import Noise
from jbf.estimation.problem import Problem
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Lines, Solution

NEAR = 0.3
"""Largest relative difference of each parameter between two points compared for equivalence."""
SAME = 0.1
"""Largest difference of predictions at equivalent points, as a fraction of the residual.

It applies to both linear models; the sums of squares then differ by about one hundredth."""
ENDED = 1e-6
"""Relative difference of sums of squares at which a search ends."""
NEAR_MINIMUM = 0.5
"""Gain (`least_gain`) at which a search ends whose result is only compared with others.

These are fits of candidates, refits for held-out runs, fits with a given delay, and the first
search of a fit. The gain is small compared with that by which an effect is accepted."""
LONGEST = 3.0
"""Largest change of the logarithm of a scale parameter in one step: a factor of 20."""
REACH = 5.0
"""Range of a scan for other maxima, as a factor on the value upwards and downwards."""
POINTS = 41
"""Number of points of a scan for other maxima."""
CLIMBED = 2
"""Number of maxima of a scan that are followed by a search."""


@dataclass(frozen=True)
class SearchPoint:
    """A point of a search with its innovations and their Jacobian.

    Attributes
    ----------
    x, values, searched
        Search variables, all parameter values, and the values of the searched parameters.
    residual, jacobian, count
        Innovations and their derivatives in reduced rows, and the number of innovations.
    """

    x: Array
    values: Array
    searched: Array
    residual: Array
    jacobian: Array
    count: int

    @property
    def square(self) -> float:
        """Sum of squares of the innovations, N^2."""
        return float(self.residual @ self.residual)


@dataclass
class Visited:
    """Points of one objective function that searches have visited.

    Attributes
    ----------
    points
        Point by the key of its parameter values.
    ended
        Points of each search that ended, in order.
    lowest
        Point with the smallest sum of squares, with residuals and Jacobian of all samples.
    """

    points: dict[bytes, SearchPoint] = field(default_factory=dict)
    ended: list[list[SearchPoint]] = field(default_factory=list)
    lowest: tuple[SearchPoint, Lines] | None = None

    def store(self, point: SearchPoint, lines: Lines | None) -> None:
        """Store a point; residuals and Jacobian of all samples are kept for the lowest one."""
        self.points[_key(point.values)] = point
        if lines is not None and (self.lowest is None or point.square < self.lowest[0].square):
            self.lowest = (point, lines)

    def lines_at(self, values: Array) -> Lines | None:
        """Residuals and Jacobian at the lowest point if it has these values, otherwise None."""
        if self.lowest is None or self.at(values) is not self.lowest[0]:
            return None
        return self.lowest[1]

    def at(self, values: Array) -> SearchPoint | None:
        """Point with these values if a search has visited it, otherwise None."""
        return self.points.get(_key(values))

    def square(self, problem: Problem, samples: Samples, values: Array) -> float:
        """Sum of squares of weighted residuals, N^2, for white noise."""
        point = self.at(values)
        # Random effects are removed from innovations, but not from residuals.
        if point is not None and samples.between is None:
            return point.square
        return problem.square(values, samples)


@dataclass(frozen=True)
class SearchEnd(SearchResult):
    """End of a search: parameter values instead of search variables, and what is known there.

    `lines` has the residuals and the Jacobian at the values; None if they are not held in memory.
    """

    lines: Lines | None = None


class _Joined(Exception):
    """Signal that a search has reached a point that another search has visited."""


def search(
    problem: Problem,
    samples: Samples,
    start: Array,
    noise: Noise,
    evaluations: int,
    visited: Visited | None = None,
    least_gain: float = 0.0,
    lines: Lines | None = None,
) -> SearchEnd:
    """Minimise the squared innovations from one starting point.

    Parameters
    ----------
    evaluations
        Maximum number of evaluations of residuals and Jacobian (`minimise`).
    visited
        Evaluations of other searches of this problem, on these samples and with this noise. The
        search ends at a point visited by one of them that ended lower.
    least_gain
        Increase of twice the log likelihood, predicted or achieved by a step, below which the
        search ends. The tolerance of the relative decrease of the sum of squares is the larger of
        `ENDED` and `least_gain` divided by the number of samples.
    lines
        Residuals and Jacobian of all samples at the starting point, if they are known.
    """
    memory = Visited() if visited is None else visited
    path: list[SearchPoint] = []

    def evaluate(x: Array) -> tuple[Array, Array]:
        """Innovations and Jacobian at the variables `x`; in triangular form if memory is limited.

        It adds the point to the path. `_Joined` is raised if another search has visited it.
        """
        values = problem.decode(x, start)
        point, known = memory.at(values), None
        if problem.fits_in_memory:
            at_start = lines if not path else None
            known = memory.lines_at(values) or at_start or problem.linearise(values)
            r, j = samples.stacked(*known, noise)
            count = len(r)
        elif point is None:
            r, j, count = problem.gauss_newton_rows(values, samples, noise)
        else:
            r, j, count = point.residual, point.jacobian, point.count
        if point is None:
            problem.best.update(values, float(r @ r) / max(count, 1))
            point = SearchPoint(
                problem.encode(values), values, values[problem.open], *triangular(r, j), count
            )
            memory.store(point, known)
        if not path or path[-1] is not point:
            path.append(point)
            if visited is not None and any(_joins(point, other) for other in memory.ended):
                raise _Joined
        return r, j

    def residuals(x: Array) -> Array:
        """Innovations at the variables `x`."""
        values = problem.decode(x, start)
        r = samples.whitened(problem.residuals(values), noise)
        problem.best.update(values, float(r @ r) / max(len(r), 1))
        return r

    longest = np.where(problem.log[problem.open], LONGEST, np.inf)
    try:
        end = minimise(
            evaluate,
            problem.encode(start),
            (problem.encode(problem.lower), problem.encode(problem.upper)),
            longest,
            evaluations,
            max(ENDED, least_gain / max(samples.count, 1)),
            residuals if problem.fits_in_memory else None,
        )
    except _Joined:
        least = min(path, key=lambda point: point.square)
        return SearchEnd(least.values, False, "joined another search")
    if visited is not None:
        memory.ended.append(path)
    values = problem.decode(end.values, start)
    return SearchEnd(values, end.converged, end.message, memory.lines_at(values))


def search_solution(
    problem: Problem,
    samples: Samples,
    start: Array,
    noise: Noise,
    evaluations: int,
    least_gain: float = 0.0,
    lines: Lines | None = None,
) -> Solution:
    """Return the solution at the end of a search from one starting point (`search`)."""
    end = search(problem, samples, start, noise, evaluations, least_gain=least_gain, lines=lines)
    return problem.solution(
        problem.wrapped(end.values), samples, noise, end.converged, end.message, end.lines
    )


def _key(values: Array) -> bytes:
    """Dictionary key of parameter values, insensitive to rounding errors in their last bits."""
    part, power = np.frexp(values)
    key: Array = np.ldexp(np.round(np.ldexp(part, 44)), power - 44)
    return key.tobytes()


def _joins(point: SearchPoint, other: list[SearchPoint]) -> bool:
    """Whether a point is equivalent to one of another search that ended at most as high."""
    if min(visited.square for visited in other) > (1.0 + ENDED) * point.square:
        return False
    return any(_equivalent(point, visited) for visited in other)


def _equivalent(a: SearchPoint, b: SearchPoint) -> bool:
    """Whether two points are equivalent for the data, by the linear models at both."""
    size = np.maximum(np.abs(a.searched), np.abs(b.searched))
    far = np.abs(a.searched - b.searched) > NEAR * size
    # Parameters that the data do not determine may differ by any amount.
    if np.any(far & (np.any(a.jacobian, axis=0) | np.any(b.jacobian, axis=0))):
        return False
    step = a.x - b.x
    most = SAME**2 * min(a.square, b.square)
    return all(float(np.sum((point.jacobian @ step) ** 2)) <= most for point in (a, b))


def other_peaks(
    square: Callable[[Array], float], values: Array, index: int, lower: float, upper: float
) -> list[Array]:
    """Best local minima of `square` as a function of one parameter, except the current one.

    `square` is the sum of squares as a function of the parameter values. The parameter with the
    index `index`, a positive scale, has the bounds `lower` and `upper`.
    """
    reach = np.log(REACH)
    scanned = values[index] * np.exp(np.linspace(-reach, reach, POINTS))
    scanned = scanned[(scanned > lower) & (scanned < upper)]

    def with_value(value: float) -> Array:
        """Return a copy of the parameter values with another value of the scanned parameter."""
        moved: Array = values.copy()
        moved[index] = value
        return moved

    squares = np.array([square(with_value(value)) for value in scanned])
    around = np.pad(squares, 1, constant_values=np.inf)
    lowest = (squares <= around[:-2]) & (squares <= around[2:])
    # Minima within the grid spacing are the current one.
    lowest &= np.abs(np.log(scanned / values[index])) > reach / POINTS
    best = sorted(np.flatnonzero(lowest), key=lambda k: squares[k])[:CLIMBED]
    return [with_value(float(scanned[k])) for k in best]
