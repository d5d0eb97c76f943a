"""Errors of fits along known motions, against least squares with derivatives by differences."""

from __future__ import annotations

import jbf
import numpy as np
import pytest

TRUTH = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
SWINGS = [
    (np.linspace(2.0 * np.pi / w, 4.0 * np.pi / w, 150)[1:-1], (0.127, w, 0.0))
    for w in (0.0225, 0.25, 2.0)
]
NOISE = 0.002


def friction(values: dict[str, float], tolerance: float = 1e-6) -> np.ndarray:
    done = jbf.trajectories(jbf.Rig.thesis(), values, SWINGS, tolerance=tolerance)
    return np.concatenate([d.friction_coefficient for d in done])


def fitted(clean: np.ndarray, seed: int) -> tuple[jbf.TrajectoryFit, np.ndarray]:
    data = clean + NOISE * np.random.default_rng(seed).standard_normal(len(clean))
    pieces = np.split(data, len(SWINGS))
    return jbf.fit_trajectories(jbf.Rig.thesis(), SWINGS, pieces, start=TRUTH), data


def test_errors_are_those_of_least_squares() -> None:
    found, data = fitted(friction(TRUTH), 5)
    columns = []
    for name, value in found.values.items():
        up, down = ({**found.values, name: value * (1.0 + h)} for h in (1e-4, -1e-4))
        columns.append((friction(up, 1e-10) - friction(down, 1e-10)) / (2e-4 * value))
    x = np.stack(columns, 1)
    # Of the smooth part: at a reversal a difference straddles the jump.
    left = data - friction(found.values)
    assert found.sum_of_squares == pytest.approx(left @ left, rel=1e-3)
    covariance = np.linalg.inv(x.T @ x) * (left @ left) / (len(data) - len(TRUTH))
    for (name, p), error in zip(
        found.parameters.items(), np.sqrt(np.diag(covariance)), strict=True
    ):
        assert p.stderr == pytest.approx(error, rel=0.01), name


def test_errors_cover_the_truth_as_often_as_they_say() -> None:
    clean, off = friction(TRUTH), []
    for seed in range(20):
        found, _ = fitted(clean, seed)
        for name, p in found.parameters.items():
            assert p.stderr is not None
            off.append((p.value - TRUTH[name]) / p.stderr)
    # 80 deviations, some of them correlated: their spread is known to some 12 %.
    assert np.std(off) == pytest.approx(1.0, abs=0.25)
