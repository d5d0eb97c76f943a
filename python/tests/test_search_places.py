"""Where a search begins, goes and ends, on least squares whose minimum is known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.noise import WHITE
from jbf.estimation.problem import Best
from jbf.estimation.samples import Samples
from jbf.estimation.search import Place, Visited, search

DESIGN = np.array([[1.0, 2.0], [3.0, -1.0], [0.5, 0.5], [1.0, 0.0]])
TARGET = np.array([4.0, 1.0, 2.0, 0.5])
LEAST = np.asarray(np.linalg.lstsq(DESIGN, TARGET, rcond=None)[0])
LEFT = TARGET - DESIGN @ LEAST
COUNT = 8
"""Innovations that the four rows stand for."""


class Linear:
    """Forces that are linear in two parameters; which values were asked for."""

    def __init__(
        self, unit: float = 1.0, low: Array | None = None, high: Array | None = None
    ) -> None:
        self.unit = unit
        self.lower = np.array([-50.0, -50.0]) if low is None else low
        self.upper = np.array([50.0, 50.0]) if high is None else high
        self.open, self.few_numbers, self.best = [0, 1], False, Best()
        self.asked: list[Array] = []

    def encode(self, values: Array) -> Array:
        return values.copy()

    def decode(self, x: Array, base: Array) -> Array:
        return x.copy()

    def gauss_newton_rows(
        self, values: Array, samples: Any, noise: Any, lines: Any
    ) -> tuple[Array, Array, int]:
        self.asked.append(values)
        return self.unit * (TARGET - DESIGN @ values), self.unit * DESIGN, COUNT


SAMPLES = Samples((), (), (), ())


def searched(problem: Any, start: Array, method: Any = "dogbox") -> Any:
    return search(problem, SAMPLES, start, WHITE, 30, method)


@pytest.mark.parametrize("method", ["dogbox", "trf"])
@pytest.mark.parametrize("unit", [1e-4, 1.0, 1e4])
def test_forces_of_any_size_are_fitted(unit: float, method: str) -> None:
    problem = Linear(unit)
    found = searched(problem, np.array([10.0, -7.0]), method)
    assert found.converged
    assert found.values == pytest.approx(LEAST, rel=1e-4)
    # The best that was seen is told as a mean square.
    assert problem.best.square == pytest.approx(unit**2 * float(LEFT @ LEFT) / COUNT, rel=1e-6)
    assert problem.best.values is not None
    assert problem.best.values == pytest.approx(LEAST, rel=1e-4)


@pytest.mark.parametrize(
    ("width", "margin"), [(100.0, 1e-7), (4.0, 4e-9), (0.5, 1e-9), (2.0**-29, 2.0**-31)]
)
def test_a_search_begins_inside_its_bounds(width: float, margin: float) -> None:
    """By a billionth of their width or of one, and no further than a quarter of the width."""
    low, high = np.zeros(2), np.full(2, width)
    for start, first in (
        (low, low + margin),
        (high, high - margin),
        (low - 7.0, low + margin),
        (high + 7.0, high - margin),
        (0.5 * high, 0.5 * high),
    ):
        problem = Linear(low=low, high=high)
        searched(problem, start)
        assert problem.asked[0] == pytest.approx(first, rel=1e-13, abs=1e-4 * margin)
        assert all(np.all((v >= low) & (v <= high)) for v in problem.asked)


def place(values: Array, square: float = 1.0) -> Place:
    return Place(values, values, values, np.array([np.sqrt(square)]), np.ones((1, 1)), 1)


@pytest.mark.parametrize("size", [1.5, 3e-9, -7e12])
def test_places_are_one_to_a_few_bits(size: float) -> None:
    """A logarithm and back changes some of the last eight of 52: of those nothing is asked."""
    seen = Visited()
    there = place(np.array([size, 0.0]))
    seen.come(there, None)
    part, power = np.frexp(size)
    bit = float(np.ldexp(np.sign(part), int(power) - 44))
    for off, same in ((0.0, True), (0.4, True), (-0.4, True), (1.0, False), (-1.0, False)):
        assert (seen.at(np.array([size + off * bit, 0.0])) is there) == same
    assert seen.at(np.array([-size, 0.0])) is None
    assert seen.at(np.array([size, bit])) is None
    assert seen.at(np.array([2.0 * size, 0.0])) is None


def test_the_lowest_place_keeps_what_every_sample_says() -> None:
    """Of as low a one the first; of values elsewhere nothing is known."""
    seen = Visited()
    lines: Any = [([np.zeros(1)], [np.zeros((1, 1))]) for _ in range(4)]
    places = [place(np.array([float(k)]), square) for k, square in enumerate((3.0, 1.0, 1.0, 2.0))]
    assert seen.lines_at(np.array([0.0])) is None
    for there, said in zip(places, lines, strict=True):
        seen.come(there, said)
    seen.come(place(np.array([9.0]), 0.5), None)
    assert seen.lines_at(np.array([1.0])) is lines[1]
    for other in (0.0, 2.0, 3.0, 9.0, 17.0):
        assert seen.lines_at(np.array([other])) is None


def test_a_square_that_is_known_is_not_asked_for_again() -> None:
    """But where runs deviate: that is taken off innovations, and not off residuals."""
    seen = Visited()
    seen.come(place(np.array([1.0]), 5.0), None)
    problem: Any = SimpleNamespace(square=lambda values, samples: 77.0)
    even: Any = SimpleNamespace(between=None)
    differ: Any = SimpleNamespace(between="zero")
    assert seen.square(problem, even, np.array([1.0])) == pytest.approx(5.0)
    assert seen.square(problem, even, np.array([2.0])) == 77.0
    assert seen.square(problem, differ, np.array([1.0])) == 77.0
