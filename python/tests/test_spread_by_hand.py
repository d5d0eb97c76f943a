"""Errors of linear models and long-run variances, by sums that are written out."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from jbf.estimation.long_run import (
    _white,
    between_runs,
    long_run_variance,
    score_inflation,
    score_square,
    sure_inflation,
)
from jbf.estimation.noise import WHITE
from jbf.estimation.samples import Samples
from jbf.estimation.solution import Solution
from jbf.estimation.spread import spread

Array = npt.NDArray[np.float64]


# ---- long-run variances ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("n", "step_s", "length"),
    [(40, 1.0, 3), (40, 0.5, 5), (40, 0.001, 5), (40, 2.0, 1), (40, 50.0, 1), (7, 0.5, 1)],
)
def test_windows_are_three_seconds_long_or_an_eighth_of_the_record(
    n: int, step_s: float, length: int
) -> None:
    """Every window's sum, squared; as many times as windows fit side by side."""
    scores = np.random.default_rng(n).standard_normal((n, 2))
    windows = [scores[k : k + length].sum(axis=0) for k in range(n - length + 1)]
    wanted = sum(np.outer(w, w) for w in windows) * n / (len(windows) * length)
    assert long_run_variance(scores, step_s) == pytest.approx(wanted)


def test_a_score_is_squared_over_its_variance_or_that_of_white_noise() -> None:
    """Of a level c beside swings of a: 16 c^2 over a^2, or over one."""
    swings = np.where(np.arange(16) % 2, 1.0, -1.0)
    way = np.full((16, 1), 0.25)
    for a, over in ((10.0, 100.0), (2.0, 4.0), (0.5, 1.0)):
        found = score_square(way, 0.7 + a * swings, 3.0)
        assert found == pytest.approx(16.0 * 0.49 / over)


def test_inflation_is_the_variance_of_the_score_over_that_of_white_noise() -> None:
    """By windows of one sample: squares of direction times what it leaves of the innovations."""
    random = np.random.default_rng(2)
    d = [random.standard_normal(n) for n in (30, 20)]
    e = [4.0 * np.abs(x) * random.standard_normal(len(x)) for x in d]
    e[1][3] = 0.0
    square = sum(float(x @ x) for x in d)
    along = sum(float(a @ b) for a, b in zip(d, e, strict=True)) / square
    found = sum(float(np.sum((a * (b - along * a)) ** 2)) for a, b in zip(d, e, strict=True))
    # Of innovations that are nothing there was none.
    white = sum(float(x @ x) for x in e) / 49.0
    wanted = found / (square * white)
    assert wanted > 1.2
    for scale in (1e-200, 1.0, 1e200):
        given = [scale * x for x in d]
        assert score_inflation(given, e, (3.0, 3.0)) == pytest.approx(wanted)
    assert score_inflation(d, [1e-3 * x for x in e], (3.0, 3.0)) == pytest.approx(wanted)
    # Swings along the direction alone are no more than white noise makes of it.
    swings = [np.where(np.arange(len(x)) % 2, 1.0, -1.0) for x in d]
    assert score_inflation([np.ones(30), np.ones(20)], swings, (0.1, 0.1)) == 1.0
    assert score_inflation([np.full(30, np.inf)], [e[0]], (3.0,)) == 1.0
    assert score_inflation([], [], ()) == 1.0


@pytest.mark.parametrize(("ratio", "sure"), [(1.4, False), (2.6, True)])
def test_a_few_windows_must_scatter_beyond_a_hundredth(ratio: float, sure: bool) -> None:
    """Of 20 windows a chi-square over its degrees is 1.88 once in a hundred times."""
    way = np.zeros(400)
    way[::20] = 1.0
    e = np.where(np.arange(400) % 2, 1.0, -1.0)
    there = np.flatnonzero(way)
    # Twenty innovations of this square, whose sum is nothing, in white noise of one.
    size = np.sqrt(ratio * 380.0 / (400.0 - 20.0 * ratio))
    e[there] = size * np.where(np.arange(20) % 2, 1.0, -1.0)
    assert score_inflation([way], [e], (3.0,)) == pytest.approx(ratio)
    assert sure_inflation([way], [e], (3.0,)) == (pytest.approx(ratio) if sure else 1.0)
    assert sure_inflation([1e150 * way], [e], (3.0,)) == (pytest.approx(ratio) if sure else 1.0)


@pytest.mark.parametrize(("inflation", "told"), [(1.02, False), (0.98, True)])
def test_runs_scatter_beyond_chance_by_a_chi_square(inflation: float, told: bool) -> None:
    """Three runs have two degrees: exp(-q / 2) is a hundredth at q = 9.21."""
    pull, size = np.array([3.0, -3.0, 3.0]), np.array([1.0, 1.0, 4.0])
    d = [np.array([np.sqrt(s), 0.0, 0.0]) for s in size]
    e = [np.array([p / np.sqrt(s), 2.0, -2.0]) for p, s in zip(pull, size, strict=True)]
    white = np.mean(np.concatenate(e) ** 2)
    least = float(np.sum(pull**2 / size)) / white / (2.0 * np.log(100.0))
    found = between_runs(d, e, inflation * least)
    # The square of the pulls over the white one, for three of which one is the mean's.
    assert found == (pytest.approx(27.0 / (white * 6.0) * 1.5) if told else 0.0)
    # A run in which it does not show is none of them.
    more = [*d, np.zeros(3)], [*e, np.zeros(3)]
    assert (between_runs(*more, inflation * least) > 0.0) == told
    assert between_runs(d[:2], e[:2], 1e-9) == 0.0
    assert between_runs(d, [np.zeros(3)] * 3, 1e-9) == 0.0


# ---- errors of a fit ---------------------------------------------------------------------------


def solved(
    columns: list[Array], values: list[float], log: list[bool]
) -> tuple[Any, Solution, Array]:
    """A solution in white noise that no column knows anything of, in two runs."""
    j = np.column_stack(columns)
    n = len(j)
    swings = np.where(np.arange(n) % 2, 2.0, -2.0)
    r = swings - j @ np.linalg.lstsq(j, swings, rcond=None)[0]
    masks = tuple(np.ones(k, dtype=bool) for k in (n // 2, n - n // 2))
    weight = tuple(m.astype(float) for m in masks)
    samples = Samples(("a", "b"), (0.02, 0.02), masks, weight)
    parts, rows = np.split(r, [n // 2]), np.split(j, [n // 2])
    found = Solution((), np.array(values), parts, rows, WHITE, 0.0, True, "", samples)
    problem: Any = SimpleNamespace(log=np.array(log), open=list(range(len(values))))
    return problem, found, r


def test_white_noise_is_the_mean_square_of_what_counts() -> None:
    for innovations, square in (([3.0], 9.0), ([3.0, 0.0, 4.0], 12.5), ([0.0], 0.0), ([], 0.0)):
        assert _white([np.array(innovations), np.zeros(5)]) == square


def test_errors_are_those_of_linear_regression() -> None:
    """In the parameter's own unit: of a logarithm times the value."""
    t = np.linspace(-1.0, 1.0, 300)
    columns = [np.ones(300), t + 0.5, np.sin(9.0 * t)]
    problem, solution, r = solved(columns, [5.0, -0.2, -3.0], [True, False, True])
    found = spread(problem, solution)
    x = np.column_stack(columns)
    covariance = float(r @ r) / 297.0 * np.linalg.inv(x.T @ x)
    sd = np.sqrt(np.diag(covariance))
    assert found.sd == pytest.approx(sd)
    assert found.scale.tolist() == [5.0, 1.0, 3.0]
    assert found.correlation == pytest.approx(covariance / np.outer(sd, sd))
    assert found.moved.tolist() == found.separate.tolist() == [True] * 3
    # Swings from sample to sample average out sooner than white noise.
    assert found.inflation.tolist() == [1.0] * 3
    assert [found.error(k) for k in range(3)] == pytest.approx(sd * [5.0, 1.0, 3.0])


def test_units_of_parameters_do_not_matter() -> None:
    t = np.linspace(-1.0, 1.0, 300)
    problem, solution, _ = solved([np.ones(300), t + 0.5], [1.0, 1.0], [False, False])
    plain = spread(problem, solution)
    problem, solution, _ = solved([1e-3 * np.ones(300), 1e4 * (t + 0.5)], [1.0] * 2, [False] * 2)
    scaled = spread(problem, solution)
    assert scaled.sd * [1e-3, 1e4] == pytest.approx(plain.sd)
    assert scaled.correlation == pytest.approx(plain.correlation)
    assert np.all(scaled.moved)
    assert np.all(scaled.separate)


def test_what_does_not_move_has_no_error_and_what_is_one_is_not_separate() -> None:
    t = np.linspace(-1.0, 1.0, 300)
    columns = [np.ones(300), 1e-12 * t, t, 3.0 * t]
    problem, solution, _ = solved(columns, [1.0] * 4, [False] * 4)
    found = spread(problem, solution)
    assert found.moved.tolist() == [True, False, True, True]
    assert found.separate.tolist() == [True, True, False, False]
    assert np.isfinite(found.sd).tolist() == [True, False, True, True]
    assert found.inflation[1] == 1.0
    # A thousand-millionth of the largest is nothing yet.
    for least, seen in ((1e-9, False), (1.01e-9, True)):
        for unit in (1.0, 1024.0, 2.0**-20):
            one, other = unit * np.eye(300)[0], unit * least * np.eye(300)[1]
            problem, solution, _ = solved([one, other], [1.0] * 2, [False] * 2)
            assert spread(problem, solution).moved.tolist() == [True, seen]
    nothing, solution, _ = solved([np.zeros(300)], [1.0], [False])
    still = spread(nothing, solution)
    assert (still.moved.tolist(), still.separate.tolist()) == ([False], [True])
    assert np.isnan(still.error(0))


def test_slow_noise_makes_errors_as_much_larger_as_it_remembers() -> None:
    """What keeps its sign for ten samples has ten times the variance in its mean."""
    n = 4000
    problem, solution, _ = solved([np.ones(n)], [1.0], [False])
    random = np.random.default_rng(4)
    slow = np.repeat(random.choice([-1.0, 1.0], n // 10), 10)
    parts = np.split(slow - slow.mean(), [n // 2])
    coloured = replace(solution, residuals=parts)
    assert spread(problem, coloured).inflation[0] ** 2 == pytest.approx(10.0, rel=0.5)
