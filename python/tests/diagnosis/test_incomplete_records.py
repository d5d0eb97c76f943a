"""Records without a speed, and records without a force to fit."""

from pathlib import Path

import numpy as np
import pytest
from by_hand import Array
from conftest import LAW, make_runs
from jbf import Model, Rig, Run, compare, fit, read_run, read_runs
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign

TIME_S = 0.02 * np.arange(1500)
SPEED_M_S = 0.05 * np.sin(0.8 * TIME_S)
POSITION_M = -0.05 / 0.8 * np.cos(0.8 * TIME_S)
FORCE_N = 20.0 * np.tanh(SPEED_M_S / 1e-3) + 0.3 * np.random.default_rng(1).standard_normal(1500)


def test_speed_is_computed_from_angle_and_radius_if_it_is_missing(tmp_path: Path) -> None:
    runs = make_runs(kinds=("sine_w0.5", "sine_w2.0"))
    for run in runs:
        columns = run.columns()
        del columns["velocity_m_s"]
        bare = Run.from_arrays(**columns, name=run.name)  # type: ignore[arg-type]
        assert np.isnan(bare.velocity).all()
        bare.write_csv(tmp_path / f"{run.name}.csv")
    read = read_runs(tmp_path)
    model = Model(Rig.thesis(), parameters=LAW)
    for run, without in zip(runs, read, strict=True):
        np.testing.assert_allclose(model.predict(without), model.predict(run), atol=0.3)
    found, expected = (fit(Rig.thesis(), some) for some in (read, runs))
    assert found.rms == pytest.approx(expected.rms, rel=0.02)
    assert [finding.kind for finding in found.findings] == ["no_speed", "no_speed"]
    assert compare(model, read).rms == pytest.approx(compare(model, runs).rms, rel=0.02)


def test_angle_without_speed_and_radius_is_rejected() -> None:
    run = Run.from_arrays(TIME_S, None, FORCE_N, angle_rad=POSITION_M, name="a")
    with pytest.raises(InputError, match=r"a, column velocity_m_s: .*radius"):
        Campaign.prepare(Rig(), [run])


def test_record_without_speed_angle_and_position_is_rejected(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="velocity_m_s"):
        Run.from_arrays(TIME_S, None, FORCE_N)
    (tmp_path / "a.csv").write_text("time_s,friction_n\n" + "".join(f"{i},1\n" for i in range(20)))
    with pytest.raises(InputError, match="column velocity_m_s: is missing"):
        read_run(tmp_path / "a.csv")


def _run(speed_m_s: Array, force_n: Array, name: str) -> Run:
    return Run.from_arrays(0.01 * np.arange(len(speed_m_s)), speed_m_s, force_n, name=name)


def test_force_that_is_zero_in_every_run_is_rejected() -> None:
    speeds = [np.sin(k + 0.03 * np.arange(200)) for k in (1, 2)]
    empty = [_run(v, np.zeros(200), f"run{k}") for k, v in enumerate(speeds)]
    with pytest.raises(InputError, match=r"run0, column friction_n: is zero in every sample"):
        fit(Rig(), empty, law="stribeck")
    measured = _run(speeds[0], np.sign(speeds[0]), "run2")
    assert fit(Rig(), [measured, *empty], law="coulomb").parameters


@pytest.mark.parametrize(
    ("speed_m_s", "named"),
    [
        (np.zeros(300), "run_a"),
        (
            np.random.default_rng(1).choice([-5.0, -1.5, 0.0, 1.5, 5.0], 900),
            "run_a, column velocity_m_s: the direction of motion is undetermined",
        ),
    ],
    ids=["at rest", "random sign"],
)
@pytest.mark.filterwarnings("error")
def test_run_without_a_known_sign_of_motion_is_rejected(speed_m_s: Array, named: str) -> None:
    run = _run(speed_m_s, np.sign(speed_m_s) + 0.2 * speed_m_s + 1.0, "run_a")
    with pytest.raises(InputError, match=named):
        fit(Rig(), [run], law="stribeck")
