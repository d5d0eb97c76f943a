"""Trajectories and fits along known motions, against an independent solver and least squares."""

from functools import cache
from typing import Any

import jbf
import numpy as np
import pytest
from by_hand import Array
from jbf import InputError

RIG = jbf.Rig.thesis()
TRUTH = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
NOISE = 0.002
SWINGS: list[tuple[Array, tuple[float, float, float]]] = [
    (np.linspace(2.0 * np.pi / w, 4.0 * np.pi / w, 150)[1:-1], (0.127, w, 0.0))
    for w in (0.0225, 0.25, 2.0)
]
"""One period of each of three sines; amplitude, angular frequency and mean."""
EXTENDED = pytest.mark.extended

# U = 0.127 sin(t), journal clock; columns: time, eps, phi, f of an independent implementation.
REDUCED = np.array(
    [
        [0.125663706143592, 0.9811143275586, 0.105320026112, 0.04785707000713],
        [0.628318530717959, 0.9709475166744, 0.2006845873701, 0.005924049780859],
        [3.39292006587698, 0.9835386354119, 0.1243953364082, -0.07876862088309],
        [6.47168086639497, 0.9845106418236, 0.1022116140289, 0.09170630580666],
    ]
)
FULL = np.array(
    [
        [0.0628318530717959, 0.978306644424, 0.1105018400756, 0.02211412219954],
        [0.251327412287183, 0.9817708318181, 0.1297366742794, 0.05664560670304],
    ]
)


def friction(values: dict[str, float], tolerance: float = 1e-6, model: str = "journal") -> Array:
    done = jbf.trajectories(RIG, values, SWINGS, tolerance=tolerance, model=model)
    return np.concatenate([d.friction_coefficient for d in done])


@cache
def clean() -> Array:
    return friction(TRUTH)


def noisy(seed: int) -> Array:
    return clean() + NOISE * np.random.default_rng(seed).standard_normal(len(clean()))


@pytest.mark.parametrize(
    ("model", "rows", "tol"), [("journal", REDUCED, 1e-9), ("journal_full", FULL, 1e-7)]
)
def test_trajectory_agrees_with_an_independent_solver(model: str, rows: Array, tol: float) -> None:
    options: dict[str, Any] = {"sine": (0.127, 1.0), "model": model, "tolerance": 0.3 * tol}
    found = jbf.trajectory(RIG, TRUTH, rows[:, 0], **options)
    np.testing.assert_allclose(found.friction_coefficient, rows[:, 3], atol=tol, rtol=0)
    np.testing.assert_allclose(found.eps, rows[:, 1], atol=tol, rtol=0)
    np.testing.assert_allclose(found.phi_rad, rows[:, 2], atol=10 * tol, rtol=0)


def test_sampled_motion_has_the_friction_of_the_sine_that_it_samples() -> None:
    time = np.arange(0.0, 6.0, 0.001)
    record = jbf.trajectory(RIG, TRUTH, time, 0.02 + 0.1 * np.sin(1.5 * time))
    sine = jbf.trajectory(RIG, TRUTH, time, sine=(0.1, 1.5, 0.02))
    friction = record.friction_coefficient
    np.testing.assert_allclose(friction, sine.friction_coefficient, atol=2e-5, rtol=0)


@pytest.mark.parametrize("model", ["journal", pytest.param("journal_full", marks=EXTENDED)])
def test_trajectory_derivatives_agree_with_fourth_order_differences(model: str) -> None:
    done = jbf.trajectories(RIG, TRUTH, SWINGS, model=model, tolerance=1e-9, derivatives=True)
    found = np.concatenate([d.derivatives for d in done if d.derivatives is not None])
    for k, (name, value) in enumerate(TRUTH.items()):
        h = 1e-4 * value
        far, near = (
            friction(TRUTH | {name: value + s * h}, 1e-11, model)
            - friction(TRUTH | {name: value - s * h}, 1e-11, model)
            for s in (2.0, 1.0)
        )
        expected = (8.0 * near - far) / (12.0 * h)
        assert np.max(np.abs(found[:, k] - expected)) < 2e-6 * np.max(np.abs(expected))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"tolerance": 0.0}, "tolerance"),
        ({"model": "journel"}, "journel"),
        ({"sine": (0.1, -1.0)}, "omega_rad_s"),
        ({"sine": None}, "either"),
        ({"eps": 1.5}, "eps"),
        ({"time_s": [1.0, 0.5]}, "times_s"),
        ({"parameters": {**TRUTH, "K0": -1.0}}, "K0"),
        ({"parameters": {"f_m": 0.2}}, "missing"),
    ],
)
def test_invalid_argument_of_a_trajectory_is_rejected_by_name(change: Any, named: str) -> None:
    good: dict[str, Any] = {"parameters": TRUTH, "time_s": [0.5, 1.0], "sine": (0.1, 1.0)}
    with pytest.raises(InputError, match=named):
        jbf.trajectory(RIG, **{**good, **change})


def test_trajectory_fit_to_exact_friction_recovers_the_parameters() -> None:
    exact = np.split(friction(TRUTH, 1e-8), len(SWINGS))
    start = {"f_m": 0.3, "U_tr_m_s": 0.05, "K0": 6e5, "gamma": 30.0}
    found = jbf.fit_trajectories(RIG, SWINGS, exact, start=start, tolerance=1e-8)
    assert found.converged
    for name, value in TRUTH.items():
        assert found[name].value == pytest.approx(value, rel=1e-3), name
    assert found.sum_of_squares < 1e-9
    assert found.to_dict()["sum_of_squares"] == found.sum_of_squares


def test_trajectory_fit_from_distant_starts_converges_with_missing_samples() -> None:
    pieces = np.split(noisy(42), len(SWINGS))
    pieces[1][:20] = np.nan
    start = {"f_m": 0.34, "U_tr": 0.042, "K0": 9.7e5, "gamma": 23.0}
    found = jbf.fit_trajectories(RIG, SWINGS, pieces, start=start)
    assert found.converged
    assert found.evaluations < 15
    assert found.nobs == len(clean()) - 20
    assert found.sum_of_squares == pytest.approx(NOISE**2 * found.nobs, rel=0.2)
    for name, value in found.parameters.items():
        assert abs(value.value - TRUTH[name]) < 4.0 * value.stderr
        assert value.stderr < 0.1 * value.value


def test_trajectory_fit_errors_are_those_of_least_squares() -> None:
    """Covariance `s^2 (J' J)^-1`, J by differences, s^2 with n - k degrees of freedom, n = 45."""
    runs = [(time[5::10], sine) for time, sine in SWINGS]

    def along(values: dict[str, float], tolerance: float = 1e-6) -> Array:
        done = jbf.trajectories(RIG, values, runs, tolerance=tolerance)
        return np.concatenate([d.friction_coefficient for d in done])

    data = along(TRUTH)
    data += NOISE * np.random.default_rng(5).standard_normal(len(data))
    found = jbf.fit_trajectories(RIG, runs, np.split(data, len(runs)), start=TRUTH)
    columns = []
    for name, value in found.params.items():
        up, down = ({**found.params, name: value * (1.0 + h)} for h in (1e-4, -1e-4))
        columns.append((along(up, 1e-10) - along(down, 1e-10)) / (2e-4 * value))
    x = np.stack(columns, 1)
    residual = data - along(found.params)
    assert found.sum_of_squares == pytest.approx(residual @ residual, rel=1e-3)
    covariance = np.linalg.inv(x.T @ x) * (residual @ residual) / (len(data) - len(TRUTH))
    errors = np.sqrt(np.diag(covariance))
    assert list(found.stderr.values()) == pytest.approx(errors, rel=0.01)


@EXTENDED
def test_estimates_scatter_by_their_standard_errors_in_twenty_fits() -> None:
    """The standard deviation of 80 deviations, some of them correlated, has an error of 12 %."""
    off = []
    for seed in range(20):
        pieces = np.split(noisy(seed), len(SWINGS))
        found = jbf.fit_trajectories(RIG, SWINGS, pieces, start=TRUTH)
        for name, p in found.parameters.items():
            off.append((p.value - TRUTH[name]) / p.stderr)
    assert np.std(off) == pytest.approx(1.0, abs=0.25)


def test_parameters_that_the_motion_does_not_determine_are_held_without_an_error() -> None:
    """At a single constant speed one value of friction cannot determine four parameters."""
    time = np.linspace(0.0, 2.0, 40)
    runs = [(time, np.full(40, 0.1))]
    data = [jbf.trajectories(RIG, TRUTH, runs)[0].friction_coefficient]
    found = jbf.fit_trajectories(RIG, runs, data, start=TRUTH)
    held = [p for p in found.parameters.values() if p.stderr is None]
    assert held
    assert all(p.held and p.note for p in held)


def test_trajectory_fit_ignores_samples_at_rest_or_without_a_measurement() -> None:
    """Friction is set-valued at rest; the sine is at rest where its speed is zero."""
    time = np.arange(0.0, 12.0, 0.25)
    record = np.where((time > 3.0) & (time < 6.0), 0.0, 0.05 * np.sin(time))
    record[np.abs(record) < 1e-12] = 0.0
    sine = (0.1, 0.5 * np.pi, 0.1)
    speed = 0.1 + 0.1 * np.sin(0.5 * np.pi * time)
    runs = [(time, record), (time, sine)]
    data = [d.friction_coefficient.copy() for d in jbf.trajectories(RIG, TRUTH, runs)]
    data[0][-4:] = np.nan
    moving = np.sum(record[:-4] != 0.0) + np.sum(speed > 1e-9 * 0.2)
    assert np.sum(speed <= 1e-9 * 0.2) == 3
    assert jbf.fit_trajectories(RIG, runs, data, start=TRUTH).nobs == moving


def test_fit_is_rejected_if_samples_do_not_outnumber_parameters() -> None:
    few = [(np.linspace(0.5, 2.5, 5), (0.127, 0.25, 0.0))]
    data = [np.array(jbf.trajectories(RIG, TRUTH, few)[0].friction_coefficient)]
    assert jbf.fit_trajectories(RIG, few, data, start=TRUTH).nobs == 5
    data[0][0] = np.nan
    with pytest.raises(InputError, match="too few for 4 parameters"):
        jbf.fit_trajectories(RIG, few, data, start=TRUTH)


@pytest.mark.parametrize(
    ("runs", "data", "named"),
    [
        (SWINGS[:1], [], "1 runs and 0 frictions"),
        ([], [], "no run was given"),
        (SWINGS[:1] * 2, [np.ones(148), np.ones(147)], "run 1: friction of shape"),
        (SWINGS[:1], [np.full(148, np.nan)], "too few"),
        (SWINGS, "friction", "the friction is"),
        (SWINGS, None, "the friction is"),
    ],
)
def test_invalid_trajectory_data_are_rejected_with_reason(runs: Any, data: Any, named: str) -> None:
    with pytest.raises(InputError, match=named):
        jbf.fit_trajectories(RIG, runs, data)
