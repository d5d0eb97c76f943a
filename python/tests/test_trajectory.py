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


SWINGS: list[tuple[np.ndarray, tuple[float, float, float]]] = [
    (np.linspace(2.0 * np.pi / w, 4.0 * np.pi / w, 200)[1:-1], (0.127, w, 0.0))
    for w in (0.0225, 0.25, 2.0)
]


@pytest.mark.parametrize("model", ["journal", "journal_full"])
@pytest.mark.parametrize("name", list(TABLE_4_2))
def test_derivatives_are_those_of_the_friction(name: str, model: str) -> None:
    h = 1e-4 * TABLE_4_2[name]

    def at(shift: float) -> np.ndarray:
        moved = TABLE_4_2 | {name: TABLE_4_2[name] + shift * h}
        done = jbf.trajectories(RIG, moved, SWINGS, model=model, tolerance=1e-11)
        return np.concatenate([d.friction_coefficient for d in done])

    # Differences of the fourth order, of trajectories at the finest tolerance.
    expected = (at(-2) - 8.0 * at(-1) + 8.0 * at(1) - at(2)) / (12.0 * h)
    done = jbf.trajectories(RIG, TABLE_4_2, SWINGS, model=model, tolerance=1e-9, derivatives=True)
    got = np.concatenate([d.derivatives for d in done if d.derivatives is not None])
    column = got[:, list(TABLE_4_2).index(name)]
    assert np.max(np.abs(column - expected)) < 2e-6 * np.max(np.abs(expected))


def test_a_fit_along_known_motions_covers_the_truth() -> None:
    clean = [d.friction_coefficient for d in jbf.trajectories(RIG, TABLE_4_2, SWINGS)]
    random = np.random.default_rng(42)
    data = [f + 0.002 * random.standard_normal(len(f)) for f in clean]
    data[1][:20] = np.nan
    start = {"f_m": 0.34, "U_tr": 0.042, "K0": 9.7e5, "gamma": 23.0}
    found = jbf.fit_trajectories(RIG, SWINGS, data, start=start)
    assert found.converged
    assert found.evaluations < 15
    assert found.samples == 3 * 198 - 20
    assert found.sum_of_squares == pytest.approx(0.002**2 * found.samples, rel=0.2)
    for name, value in found.parameters.items():
        assert value.stderr is not None
        assert abs(value.value - TABLE_4_2[name]) < 4.0 * value.stderr
        assert value.stderr < 0.1 * value.value


def test_a_wrong_call_of_a_fit_says_what_to_mend() -> None:
    with pytest.raises(jbf.InputError, match="one array of friction coefficients a run"):
        jbf.fit_trajectories(RIG, SWINGS, [])
    with pytest.raises(jbf.InputError, match="run 0: friction of shape"):
        jbf.fit_trajectories(RIG, SWINGS[:1], [np.zeros(7)])
    with pytest.raises(jbf.InputError, match="too few"):
        jbf.fit_trajectories(RIG, SWINGS[:1], [np.full(198, np.nan)])
    with pytest.raises(jbf.InputError, match="gama"):
        jbf.fit_trajectories(RIG, SWINGS[:1], [np.zeros(198)], start={"gama": 3.0})
