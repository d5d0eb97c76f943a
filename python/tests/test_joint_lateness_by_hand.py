"""A step in every run's lateness at once: of rows and covariances that are put together by hand."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf.estimation.joint_lateness import LINEAR_S, LatenessStep, _rows, lateness_step
from jbf.estimation.lateness import instants_of
from jbf.estimation.noise import WHITE
from made_of import record, samples_of
from scipy import stats

module = sys.modules["jbf.estimation.joint_lateness"]
COVARIANCE = np.array([[4.0, 1.0], [1.0, 2.0]])
TOLD = np.array([True, False, True])
STEP = LatenessStep(np.array([3.0, 0.0, -1.0]), COVARIANCE, TOLD)


# ---- what a step says --------------------------------------------------------------------------


def test_a_step_is_squared_over_its_covariance() -> None:
    """Of two runs: (3, -1) times the inverse of ((4, 1), (1, 2)), which is ((2, -1), (-1, 4)) / 7,
    times itself again: 28 / 7."""
    assert STEP.square == pytest.approx(4.0)
    assert STEP.chance == pytest.approx(np.exp(-2.0))
    assert LatenessStep(np.zeros(3), COVARIANCE, TOLD).chance == pytest.approx(1.0)


@pytest.mark.parametrize("share", [0.25, 1.0])
def test_runs_differ_about_their_weighted_mean(share: float) -> None:
    """Late by (5, 1) before and (3, -1) more: (8, 0), whose weighted mean is 8 / 4, as the rows of
    the inverse sum to 1 and 3. (6, -2) squared is (72 + 24 + 16) / 7."""
    late_s = np.array([5.0, 99.0, 1.0])
    square = share * 112.0 / 7.0
    assert STEP.differ_chance(late_s, share) == pytest.approx(stats.chi2.sf(square, 1))
    # What all are late by is no difference.
    again = STEP.differ_chance(late_s + 40.0, share)
    assert again == pytest.approx(STEP.differ_chance(late_s, share))


def test_one_run_alone_differs_from_none() -> None:
    told = np.array([False, True])
    one = LatenessStep(np.array([0.0, 3.0]), np.array([[1.0]]), told)
    assert one.differ_chance(np.zeros(2), 1.0) == 1.0
    assert one.chance == pytest.approx(stats.chi2.sf(9.0, 1))
    assert one.mean_s(np.array([7.0, 2.0])) == 2.0
    none = LatenessStep(np.zeros(2), np.zeros((0, 0)), np.zeros(2, dtype=bool))
    assert (none.differ_chance(np.ones(2), 1.0), none.chance, none.mean_s(np.ones(2))) == (1, 1, 0)


def test_a_mean_is_of_runs_that_tell_theirs_by_how_surely() -> None:
    """6 and 3 with variances of 4 and 2: one to two."""
    assert STEP.mean_s(np.array([6.0, 99.0, 3.0])) == pytest.approx(4.0)


# ---- the step ----------------------------------------------------------------------------------


def stepped(monkeypatch: pytest.MonkeyPatch, rows: list[tuple[Array, Array, int]]) -> LatenessStep:
    """Of rows of residuals and derivatives by two parameters and the lateness; of three parameters
    of the model one is the delay that all runs share, and one is held."""
    asked: list[list[int]] = []

    def made(
        problem: Any, solution: Any, by: list[int], clocks: str
    ) -> Iterator[tuple[Array, Array, int]]:
        assert clocks == "by run"
        asked.append(by)
        yield from rows

    monkeypatch.setattr(module, "_rows", made)
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=rows),
        names=["a", "held", "time_delay.tau_s", "b"],
        open=[0, 2, 3],
    )
    found = lateness_step(problem, SimpleNamespace())  # type: ignore[arg-type]
    assert asked == [[0, 2]]
    return found


@pytest.mark.parametrize("unit", [1e-200, 1e-3, 1.0, 1e200])
def test_parameters_and_lateness_are_one_least_squares_problem(
    unit: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Forces of any size. The covariance is that of the normal equations, over all samples."""
    random = np.random.default_rng(1)
    design = [random.standard_normal((40, 3)) * [1.0, 1.0, 1e4] for _ in range(2)]
    right = [random.standard_normal(40) for _ in range(2)]
    found = stepped(
        monkeypatch,
        [(unit * r, unit * j, n) for r, j, n in zip(right, design, (500, 300), strict=True)],
    )
    x = np.zeros((80, 4))
    for i, j in enumerate(design):
        x[40 * i : 40 * i + 40, :2] = j[:, :2]
        x[40 * i : 40 * i + 40, 2 + i] = j[:, 2]
    y = np.concatenate(right)
    wanted = np.linalg.lstsq(x, y, rcond=None)[0]
    left = y - x @ wanted
    covariance = float(left @ left) / 800.0 * np.linalg.inv(x.T @ x)
    assert found.told.all()
    assert found.late_s == pytest.approx(wanted[2:], rel=1e-9)
    assert found.covariance_s2 == pytest.approx(covariance[2:, 2:], rel=1e-6)


@pytest.mark.parametrize(("sd_s", "told"), [(0.99 * LINEAR_S, True), (1.01 * LINEAR_S, False)])
def test_a_lateness_that_is_less_sure_than_a_step_goes_is_not_told(
    sd_s: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two samples a run: what a mean leaves, over its number, is its variance. Of a run without any
    slope nothing is known."""
    assert LINEAR_S == 8e-3
    still = np.zeros((2, 3))
    still[:, 0] = 1.0
    slope = np.zeros((2, 3))
    slope[:, 2] = 1.0
    both = np.zeros((2, 3))
    both[:, 1] = 1.0
    # The squares left are 2 e^2 of 6 samples, and the variance is half of a sixth of that.
    e = sd_s * np.sqrt(6.0)
    noise, none = np.array([e, -e]), np.zeros(2)
    found = stepped(monkeypatch, [(none, still, 2), (2e-3 + noise, slope, 2), (none, both, 2)])
    assert found.told.tolist() == [False, told, False]
    assert found.late_s == pytest.approx([0.0, 2e-3 if told else 0.0, 0.0])
    assert found.covariance_s2.shape == (int(told), int(told))
    if told:
        assert found.covariance_s2[0, 0] == pytest.approx(sd_s**2)


def test_where_nothing_is_left_nothing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    found = stepped(monkeypatch, [(np.zeros(3), np.zeros((3, 3)), 0)])
    assert not found.told.any()
    assert found.late_s.tolist() == [0.0]


# ---- rows --------------------------------------------------------------------------------------


@pytest.mark.parametrize(("step_s", "apart"), [(1.0 / 128.0, 2), (1.0 / 64.0, 1), (1.0 / 512.0, 5)])
def test_rows_are_of_samples_no_nearer_to_a_reversal_than_a_step_goes(
    step_s: float, apart: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A force that is later is less by its slope. Few rows hold the same squares and products."""
    n = 90
    runs, forces, slopes = [], [], []
    for i in range(2):
        run = record(3.0 + step_s * np.arange(n), name="ab"[i])
        run.motion.sign_known = np.ones(n, dtype=bool)
        run.motion.sign_known[[40, 41, 70 + i]] = False
        instants = instants_of(run)
        forces.append(np.sin((9.0 + i) * instants))
        rise = np.gradient(forces[-1], instants)
        slopes.append(-np.interp(run.run.time_s, instants, rise))
        runs.append(run)
    weight = [np.where(np.arange(n) % 2, 1.0, 0.5) for _ in runs]
    random = np.random.default_rng(2)
    solution: Any = SimpleNamespace(
        samples=samples_of(runs, None, weight),
        residuals=[random.standard_normal(n) for _ in runs],
        jacobian=[random.standard_normal((n, 3)) for _ in runs],
        noise=WHITE,
        values=None,
    )

    def predict(values: Any, motions: Any) -> list[Array]:
        (p,) = motions
        return [forces[runs.index(p)]]

    monkeypatch.setattr(module, "fine_motion", lambda p: p)
    problem: Any = SimpleNamespace(
        campaign=SimpleNamespace(prepared=runs), chain=SimpleNamespace(predict=predict)
    )
    for i, (r, j, count) in enumerate(_rows(problem, solution, [2, 0], "by run")):
        unknown = np.flatnonzero(~runs[i].motion.sign_known)
        far = np.abs(np.arange(n)[:, None] - unknown[None, :]).min(axis=1) > apart
        columns = np.column_stack([solution.jacobian[i][:, [2, 0]], slopes[i]])
        x = (columns * weight[i][:, None])[far]
        y = (solution.residuals[i] * weight[i])[far]
        assert count == int(far.sum())
        assert len(r) == 4
        assert j.T @ j == pytest.approx(x.T @ x)
        assert j.T @ r == pytest.approx(x.T @ y)
        assert r @ r == pytest.approx(y @ y)
