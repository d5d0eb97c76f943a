"""Trajectories through the bindings, against rows of an independent implementation."""

from __future__ import annotations

import jbf
import numpy as np
import pytest

TABLE_4_2 = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
RIG = jbf.Rig.thesis()

# U = 0.127 sin(t), journal clock: time, eps, phi, f of the reduced model.
REDUCED = np.array(
    [
        [0.125663706143592, 0.9811143275586, 0.105320026112, 0.04785707000713],
        [0.628318530717959, 0.9709475166744, 0.2006845873701, 0.005924049780859],
        [3.39292006587698, 0.9835386354119, 0.1243953364082, -0.07876862088309],
        [6.47168086639497, 0.9845106418236, 0.1022116140289, 0.09170630580666],
    ]
)
# The same of the full model.
FULL = np.array(
    [
        [0.0628318530717959, 0.978306644424, 0.1105018400756, 0.02211412219954],
        [0.251327412287183, 0.9817708318181, 0.1297366742794, 0.05664560670304],
    ]
)


@pytest.mark.parametrize(
    ("model", "rows", "tolerance"), [("journal", REDUCED, 1e-9), ("journal_full", FULL, 1e-7)]
)
def test_reference_rows(model: str, rows: np.ndarray, tolerance: float) -> None:
    got = jbf.trajectory(
        RIG, TABLE_4_2, rows[:, 0], sine=(0.127, 1.0), model=model, tolerance=0.3 * tolerance
    )
    np.testing.assert_allclose(got.friction_coefficient, rows[:, 3], atol=tolerance, rtol=0)
    np.testing.assert_allclose(got.eps, rows[:, 1], atol=tolerance, rtol=0)
    np.testing.assert_allclose(got.phi_rad, rows[:, 2], atol=10 * tolerance, rtol=0)
    assert got.steps > 10


def test_a_record_is_the_sine_it_samples() -> None:
    time = np.arange(0.0, 6.0, 0.001)
    speed = 0.02 + 0.1 * np.sin(1.5 * time)
    record = jbf.trajectory(RIG, TABLE_4_2, time, speed)
    sine = jbf.trajectory(RIG, TABLE_4_2, time, sine=(0.1, 1.5, 0.02))
    np.testing.assert_allclose(
        record.friction_coefficient, sine.friction_coefficient, atol=2e-5, rtol=0
    )


def test_many_runs_are_each_alone() -> None:
    time = np.linspace(0.0, 5.0, 300)
    sines = [(0.127, w, 0.0) for w in (0.1, 0.5, 2.0, 7.0)]
    together = jbf.trajectories(RIG, TABLE_4_2, [(time, sine) for sine in sines], clock="thesis")
    for sine, got in zip(sines, together, strict=True):
        alone = jbf.trajectory(RIG, TABLE_4_2, time, sine=sine, clock="thesis")
        np.testing.assert_array_equal(got.friction_coefficient, alone.friction_coefficient)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tolerance": 0.0}, "tolerance"),
        ({"model": "journel"}, "journel"),
        ({"clock": "sun"}, "sun"),
        ({"sine": (0.1, -1.0)}, "omega_rad_s"),
        ({"sine": None}, "either"),
        ({"eps": 1.5}, "eps"),
        ({"time_s": [1.0, 0.5]}, "times_s"),
        ({"parameters": {**TABLE_4_2, "K0": -1.0}}, "K0"),
        ({"parameters": {**TABLE_4_2, "K1": 1.0}}, "K1"),
        ({"parameters": {"f_m": 0.2}}, "missing"),
    ],
)
def test_refusals_name_what_is_wrong(change: dict[str, object], words: str) -> None:
    good: dict[str, object] = {"parameters": TABLE_4_2, "time_s": [0.5, 1.0], "sine": (0.1, 1.0)}
    with pytest.raises(jbf.InputError, match=words):
        jbf.trajectory(RIG, **{**good, **change})  # type: ignore[arg-type]
