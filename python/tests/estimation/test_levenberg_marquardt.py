"""Bounded nonlinear least squares: linear problems, Rosenbrock's function, and a NIST data set."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.levenberg_marquardt import minimise
from scipy import optimize

Array = npt.NDArray[np.float64]
Function = Callable[[Array], tuple[Array, Array]]


def bounds(low: list[float], high: list[float]) -> tuple[Array, Array]:
    return np.array(low), np.array(high)


def linear(seed: int) -> tuple[Function, Array, Array]:
    """Random linear problem: function, design and data."""
    random = np.random.default_rng(seed)
    design, data = random.normal(size=(20, 4)), random.normal(size=20)
    return lambda x: (data - design @ x, design), design, data


def rosenbrock(x: Array) -> tuple[Array, Array]:
    residual = -np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])
    return residual, np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])


@pytest.mark.parametrize("seed", range(5))
def test_linear_problem_within_bounds_has_the_minimum_of_quadratic_programming(seed: int) -> None:
    function, design, data = linear(seed)
    box = bounds([-0.1] * 4, [0.1] * 4)
    end = minimise(function, np.zeros(4), box, np.full(4, np.inf), 30, 1e-10)
    wanted = optimize.lsq_linear(design, data, box, tol=1e-12).x
    assert end.converged
    least, reached = (float(np.sum((data - design @ x) ** 2)) for x in (wanted, end.values))
    assert least <= reached * (1.0 + 1e-9) <= least * (1.0 + 1e-7)
    np.testing.assert_allclose(end.values, wanted, atol=1e-3)


def test_variable_at_its_bound_does_not_shorten_the_step_of_the_others() -> None:
    """Two independent variables; the first would move far beyond its bound."""
    target = np.array([10.0, 5.0])
    evaluated: list[Array] = []

    def function(x: Array) -> tuple[Array, Array]:
        evaluated.append(x)
        return target - x, np.eye(2)

    box = bounds([0.0, -100.0], [1.0, 100.0])
    end = minimise(function, np.array([0.999, 0.0]), box, np.full(2, np.inf), 10, 1e-6)
    assert end.converged
    np.testing.assert_allclose(evaluated[1], [1.0, 5.0], rtol=2e-3)
    np.testing.assert_allclose(end.values, [1.0, 5.0], rtol=1e-3)


@pytest.mark.parametrize(
    ("high", "wanted"), [(10.0, (1.0, 1.0)), (0.5, (0.5, 0.25)), (-0.2, (-0.2, 0.04))]
)
def test_minimum_of_rosenbrocks_function_within_bounds(
    high: float, wanted: tuple[float, float]
) -> None:
    box = bounds([-3.0, -3.0], [high, 3.0])
    start = np.array([-1.2, 1.0])
    end = minimise(rosenbrock, start, box, np.full(2, np.inf), 100, 1e-12)
    assert end.converged
    np.testing.assert_allclose(end.values, wanted, atol=1e-4)


MISRA1A = """
    10.07 77.6  14.73 114.9  17.94 141.1  23.93 190.8  29.61 239.9  35.18 289.0  40.02 332.8
    44.82 378.4 50.76 434.8  55.05 477.3  61.01 536.8  66.40 593.1  75.47 689.1  81.78 760.0
"""


@pytest.mark.parametrize("start", [(500.0, 1e-4), (250.0, 5e-4)])
def test_certified_values_of_the_nist_data_set_misra1a(start: tuple[float, float]) -> None:
    """Both starts and the certified values are those of NIST (Statistical Reference Datasets)."""
    y, x = np.array(MISRA1A.split(), dtype=float).reshape(-1, 2).T

    def function(b: Array) -> tuple[Array, Array]:
        decay = np.exp(-b[1] * x)
        return y - b[0] * (1.0 - decay), np.column_stack([1.0 - decay, b[0] * x * decay])

    box = bounds([0.0, 0.0], [1e6, 1.0])
    end = minimise(function, np.array(start), box, np.full(2, np.inf), 60, 1e-12)
    assert end.converged
    np.testing.assert_allclose(end.values, [2.3894212918e2, 5.5015643181e-4], rtol=1e-5)
    residual = function(end.values)[0]
    assert residual @ residual == pytest.approx(1.2455138894e-1, rel=1e-7)


def test_jacobian_is_kept_while_it_predicts_the_decrease() -> None:
    """Fit of an exponential, with and without a function for the residuals alone."""
    time = np.linspace(0.0, 3.0, 40)
    data = 2.0 * np.exp(-1.3 * time) + 0.01 * np.sin(9.0 * time)
    evaluated: list[Array] = []

    def residuals(x: Array) -> Array:
        return data - x[0] * np.exp(-x[1] * time)

    def function(x: Array) -> tuple[Array, Array]:
        evaluated.append(x)
        decay = np.exp(-x[1] * time)
        return residuals(x), np.column_stack([decay, -x[0] * time * decay])

    box, start, longest = bounds([0.0, 0.0], [9.0, 9.0]), np.array([1.0, 0.3]), np.full(2, np.inf)
    expected = minimise(function, start, box, longest, 60, 1e-12)
    calls_without = len(evaluated)
    evaluated.clear()
    end = minimise(function, start, box, longest, 60, 1e-12, residuals)
    assert end.converged
    np.testing.assert_allclose(end.values, expected.values, rtol=1e-6)
    assert len(evaluated) < calls_without
    assert evaluated[-1] is end.values
    # A search that ends early also ends at values that were evaluated.
    evaluated.clear()
    end = minimise(function, start, box, longest, 2, 1e-12, residuals)
    assert not end.converged
    assert evaluated[-1] is end.values
    assert np.sum(residuals(end.values) ** 2) < np.sum(residuals(start) ** 2)


def test_gradient_is_zero_at_the_end_although_a_kept_jacobian_predicts_no_decrease() -> None:
    """The first step zeroes one residual, which is all that the Jacobian at the start shows."""

    def residuals(x: Array) -> Array:
        return np.array([1.0 - x[0], 1.0 - 0.1 * x[0] ** 2])

    def function(x: Array) -> tuple[Array, Array]:
        return residuals(x), np.array([[1.0], [0.2 * x[0]]])

    box, longest = bounds([-9.0], [9.0]), np.full(1, np.inf)
    end = minimise(function, np.zeros(1), box, longest, 40, 1e-12, residuals)
    assert end.converged
    residual, jacobian = function(end.values)
    assert abs(float(jacobian[:, 0] @ residual)) < 1e-5


def test_search_without_sufficient_evaluations_has_not_converged() -> None:
    box = bounds([-3.0, -3.0], [3.0, 3.0])
    end = minimise(rosenbrock, np.array([-1.2, 1.0]), box, np.full(2, np.inf), 3, 1e-12)
    assert not end.converged


def test_step_is_limited_and_values_that_diverge_are_rejected() -> None:
    """The logarithm of a scale moves by at most `longest`; an infinite residual is not accepted."""
    visited: list[float] = []

    def function(x: Array) -> tuple[Array, Array]:
        visited.append(float(x[0]))
        residual = np.array([2.0 - x[0] if x[0] < 2.5 else np.inf])
        return residual, np.array([[0.5]])

    end = minimise(function, np.zeros(1), bounds([-9.0], [9.0]), np.array([3.0]), 40, 1e-9)
    assert max(np.abs(np.diff(visited[:2]))) == pytest.approx(3.0)
    assert end.values[0] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize(("share", "evaluations"), [(0.1, 1), (100.0, 3)])
def test_search_ends_if_the_predicted_decrease_is_below_the_tolerance(
    share: float, evaluations: int
) -> None:
    """Linear problem, started where a step decreases the sum of squares by a known amount."""
    function, design, data = linear(7)
    wanted, (least,), *_ = np.linalg.lstsq(design, data, rcond=None)
    tolerance = 1e-3
    direction = np.array([1.0, -2.0, 0.5, 1.0])
    away = np.sqrt(share * tolerance * least / float(np.sum((design @ direction) ** 2)))
    counted: list[Array] = []

    def evaluate(x: Array) -> tuple[Array, Array]:
        counted.append(x)
        return function(x)

    box = bounds([-1e3] * 4, [1e3] * 4)
    start = wanted + away * direction
    end = minimise(evaluate, start, box, np.full(4, np.inf), 30, tolerance)
    assert end.converged
    assert len(counted) <= evaluations
    reached = float(np.sum(function(end.values)[0] ** 2))
    assert reached <= least * (1.0 + tolerance)
    assert (len(counted) == 1) == (share < 1.0)
