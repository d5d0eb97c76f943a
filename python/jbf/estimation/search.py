"""Least squares on innovations from one starting point, by Gauss and Newton within bounds.

Searches of one problem share what they have evaluated: one that goes on where another ended does
not evaluate that place again, and one that comes to where another has been need not follow it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import optimize

from jbf.estimation.noise import Noise
from jbf.estimation.problem import Lines, Problem
from jbf.estimation.samples import Samples

Array = npt.NDArray[np.float64]
Method = Literal["dogbox", "trf"]

NEAR = 0.3
"""Two places are near one another where no parameter differs by more than this share of itself,"""
SAME = 0.1
"""and one for the data where both linear models say that predictions differ by at most this share
of the residual: squares then differ by some hundredth."""


ENDED = 1e-6
"""Relative difference of squares at which a search ends."""


@dataclass(frozen=True)
class Place:
    """Search variables, parameter values, those of them that are searched, and the rows of the
    likelihood there: innovations and their derivatives."""

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
    """The places of one likelihood that searches have come to."""

    places: dict[bytes, Place] = field(default_factory=dict)
    ended: list[list[Place]] = field(default_factory=list)
    lowest: tuple[Place, Lines] | None = None

    def come(self, place: Place, lines: Lines | None) -> None:
        """Remember a place, and of the lowest what every sample says there."""
        self.places[_key(place.values)] = place
        if lines is not None and (self.lowest is None or place.square < self.lowest[0].square):
            self.lowest = (place, lines)

    def lines_at(self, values: Array) -> Lines | None:
        """Residuals and derivatives at these values, if they are those of the lowest place."""
        if self.lowest is None or self.at(values) is not self.lowest[0]:
            return None
        return self.lowest[1]

    def at(self, values: Array) -> Place | None:
        """The place of these values, if a search has come to it."""
        return self.places.get(_key(values))

    def square(self, problem: Problem, samples: Samples, values: Array) -> float:
        """Sum of squares of weighted residuals, N^2, where white innovations are meant."""
        place = self.at(values)
        # What runs deviate by is taken off innovations, not off residuals.
        if place is not None and samples.between is None:
            return place.square
        return problem.square(values, samples)


@dataclass(frozen=True)
class Found:
    """Where a search ended: parameter values, whether it converged, and what ended it."""

    values: Array
    converged: bool
    message: str


class _Joined(Exception):
    """The search has come to where another has been."""


def search(
    problem: Problem,
    samples: Samples,
    start: Array,
    noise: Noise,
    evaluations: int,
    method: Method = "dogbox",
    visited: Visited | None = None,
) -> Found:
    """Least squares on innovations from one start.

    Parameters
    ----------
    method
        `dogbox` takes the fewest steps; `trf` stays off the bounds on its way and finds lower
        valleys where a law is wrong.
    visited
        What other searches of this problem, on these samples and under this noise, have evaluated;
        the search ends where one of them has been that ended lower.
    """
    memory = Visited() if visited is None else visited
    way: list[Place] = []

    def evaluate(x: Array) -> Place:
        values = problem.decode(x, start)
        place = memory.at(values)
        if place is None:
            keeps = visited is not None and problem.few_numbers
            lines = problem.linearise(values) if keeps else None
            r, j, count = problem.gauss_newton_rows(values, samples, noise, lines)
            problem.best.seen(values, float(r @ r) / max(count, 1))
            place = Place(problem.encode(values), values, values[problem.open], r, j, count)
            if visited is None:
                memory.places.clear()
            memory.come(place, lines)
        if not way or way[-1] is not place:
            way.append(place)
            if visited is not None and any(_joins(place, other) for other in memory.ended):
                raise _Joined
        return place

    def residual(x: Array) -> Array:
        return -evaluate(x).residual

    def jacobian(x: Array) -> Array:
        return evaluate(x).jacobian

    low, high = problem.encode(problem.lower), problem.encode(problem.upper)
    x0 = problem.encode(start)
    margin = 1e-9 * np.maximum(np.abs(high - low), 1.0)
    margin = np.minimum(margin, 0.25 * (high - low))
    try:
        found = optimize.least_squares(
            residual,
            np.clip(x0, low + margin, high - margin),
            jac=jacobian,
            bounds=(low, high),
            method=method,
            x_scale="jac",
            # A hundredth of a unit of chi-square is far below what any verdict turns on.
            xtol=1e-7,
            ftol=ENDED,
            gtol=1e-12,
            max_nfev=evaluations,
        )
    except _Joined:
        least = min(way, key=lambda place: place.square)
        return Found(least.values, False, "joined another search")
    if visited is not None:
        memory.ended.append(way)
    return Found(problem.decode(found.x, start), bool(found.status > 0), str(found.message))


def _key(values: Array) -> bytes:
    """Values but for their last few bits: a logarithm and back changes those."""
    part, power = np.frexp(values)
    key: Array = np.ldexp(np.round(np.ldexp(part, 44)), power - 44)
    return key.tobytes()


def _joins(place: Place, other: list[Place]) -> bool:
    """Whether a place is one, for the data, that another search left for one as low or lower."""
    if min(seen.square for seen in other) > (1.0 + ENDED) * place.square:
        return False
    return any(_one(place, seen) for seen in other)


def _one(a: Place, b: Place) -> bool:
    """Whether two places are one for the data, by the linear model at either."""
    size = np.maximum(np.abs(a.searched), np.abs(b.searched))
    far = np.abs(a.searched - b.searched) > NEAR * size
    # What the data do not tell may be anywhere.
    if np.any(far & (np.any(a.jacobian, axis=0) | np.any(b.jacobian, axis=0))):
        return False
    step = a.x - b.x
    most = SAME**2 * min(a.square, b.square)
    return all(float(np.sum((place.jacobian @ step) ** 2)) <= most for place in (a, b))
