"""Fits along known motions: what of a record is used, their errors, and what they say."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import Array
from jbf import InputError, Rig, threads, trajectories
from jbf.estimation.determined import NEVER_MOVED
from jbf.estimation.trajectory_fit import _errors, _usable, fit_trajectories

RIG = Rig.thesis()
TRUTH = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
TIMES = np.linspace(0.0, 30.0, 60)
SWINGS = [(TIMES, (0.127, 0.25, 0.0)), (TIMES, (0.127, 2.0, 0.0))]


def found(cost: float, jacobian: Array) -> Any:
    """A search that ended with half of this square."""
    return SimpleNamespace(cost=0.5 * cost, jac=jacobian)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_errors_are_the_values_times_those_of_their_logarithms(scale: float) -> None:
    j = scale * np.random.default_rng(1).standard_normal((50, 3)) * [1.0, 1e3, 1e-3]
    values = np.array([2.0, 3.0, 0.5])
    covariance = 7.0 / 47.0 * np.linalg.inv(j.T @ j)
    wanted = np.sqrt(np.diag(covariance)) * values
    assert _errors(found(7.0, j), values) == pytest.approx(wanted, rel=1e-6)


def test_what_is_not_shown_or_is_one_has_no_error() -> None:
    j = np.random.default_rng(1).standard_normal((50, 3))
    hidden, alike = j * [1.0, 0.0, 1.0], j.copy()
    alike[:, 2] = alike[:, 1] * (1.0 + 1e-8 * np.arange(50))
    for jacobian in (hidden, alike):
        assert np.isnan(_errors(found(7.0, jacobian), np.ones(3))).all()


def test_samples_that_were_measured_and_move_are_used() -> None:
    time = np.arange(5.0)
    record = np.array([0.0, 0.1, -0.1, 1e-11, 0.2])
    friction = np.array([1.0, np.nan, 3.0, 4.0, 5.0])
    assert _usable([(time, record)], [friction]).tolist() == [False, False, True, False, True]
    # A sine about a speed: at rest where it is back at zero.
    sine = (0.1, 0.5 * np.pi, 0.1)
    both = _usable([(time, sine), (time, record)], [np.ones(5), friction])
    # Its speed is 0.1, 0.2, 0.1, 0, 0.1.
    assert both[:5].tolist() == [True, True, True, False, True]
    assert both[5:].tolist() == [False, False, True, False, True]


@pytest.mark.parametrize(
    ("runs", "frictions", "said"),
    [
        ([(TIMES, (1.0, 1.0, 0.0))], [], "1 runs and 0 frictions"),
        ([], [], "no run was given"),
        ([(TIMES, (1.0, 1.0, 0.0))] * 2, [np.ones(60), np.ones(59)], "run 1: friction of shape"),
    ],
)
def test_runs_and_frictions_belong_together(runs: Any, frictions: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        _usable(runs, frictions)


def test_a_fit_to_exact_friction_finds_what_made_it() -> None:
    done = trajectories(RIG, TRUTH, SWINGS, tolerance=1e-8)
    clean = [d.friction_coefficient for d in done]
    start = {"f_m": 0.3, "U_tr_m_s": 0.05, "K0": 6e5, "gamma": 30.0}
    fitted = fit_trajectories(RIG, SWINGS, clean, start=start, tolerance=1e-8)
    assert fitted.converged
    for name, value in TRUTH.items():
        assert fitted[name].value == pytest.approx(value, rel=1e-3), name
    assert fitted.sum_of_squares < 1e-9
    moving = np.concatenate([np.abs(np.sin(w * TIMES)) > 1e-9 for w in (0.25, 2.0)])
    assert fitted.samples == int(moving.sum())
    told = fitted.to_dict()
    assert {n: told[n] for n in ("samples", "converged", "evaluations", "message")} == {
        "samples": fitted.samples,
        "converged": True,
        "evaluations": fitted.evaluations,
        "message": fitted.message,
    }
    assert told["sum_of_squares"] == fitted.sum_of_squares
    # Where it starts it is evaluated once, and not again for its derivatives.
    at = fit_trajectories(RIG, SWINGS, clean, start=TRUTH, tolerance=1e-8)
    assert at.evaluations <= 4
    assert at.evaluations < fitted.evaluations


@pytest.mark.parametrize(("count", "enough"), [(4, False), (5, True)])
def test_more_samples_than_parameters_are_needed(count: int, enough: bool) -> None:
    few = [(TIMES[1 : count + 1], (0.127, 0.25, 0.0))]
    friction = [trajectories(RIG, TRUTH, few)[0].friction_coefficient]
    if enough:
        assert fit_trajectories(RIG, few, friction, start=TRUTH).samples == count
    else:
        with pytest.raises(InputError, match="4 usable samples are too few for 4 parameters"):
            fit_trajectories(RIG, few, friction, start=TRUTH)


@pytest.mark.parametrize("wrong", ["friction", 3.0, None])
def test_frictions_are_a_list(wrong: Any) -> None:
    with pytest.raises(InputError, match="the friction is"):
        fit_trajectories(RIG, SWINGS, wrong)


def ended(status: int, jacobian: Array) -> Any:
    """What a search says that was over at once, having asked once for residuals and slopes."""

    def search(residuals: Any, x: Array, *, jac: Any, **more: Any) -> Any:
        left = residuals(x)
        jac(x)
        cost = 0.5 * float(left @ left)
        return SimpleNamespace(x=x, jac=jacobian, cost=cost, status=status, message="over")

    return search


@pytest.mark.parametrize(("status", "converged"), [(-1, False), (0, False), (1, True), (2, True)])
def test_what_a_search_says_of_itself_is_told(
    status: int, converged: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A parameter that moves a coefficient by a thousandth is one that the runs show."""
    from scipy import optimize

    clean = [d.friction_coefficient for d in trajectories(RIG, TRUTH, SWINGS)]
    jacobian = 1e-3 * np.random.default_rng(2).standard_normal((116, 4))
    monkeypatch.setattr(optimize, "least_squares", ended(status, jacobian))
    found = fit_trajectories(RIG, SWINGS, clean, start=TRUTH)
    assert (found.converged, found.message, found.evaluations) == (converged, "over", 1)
    assert all(p.stderr is not None for p in found.parameters.values())
    jacobian[:, 1] = 0.0
    hidden = fit_trajectories(RIG, SWINGS, clean, start=TRUTH)
    assert hidden["U_tr_m_s"].note == NEVER_MOVED


def test_linear_algebra_keeps_to_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []
    monkeypatch.setattr(threads, "_enter", lambda: asked.append("in"))
    monkeypatch.setattr(threads, "_leave", lambda: asked.append("out"))
    with pytest.raises(InputError):
        fit_trajectories(RIG, [], [])
    assert asked == ["in", "out"]
