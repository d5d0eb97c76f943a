"""A record without a speed: its path tells the motion."""

from __future__ import annotations

from pathlib import Path

import jbf
import numpy as np
import numpy.typing as npt
import pytest
from conftest import LAW, make_runs
from jbf import Model, Rig, Run
from jbf.errors import InputError
from jbf.estimation.campaign import Campaign

Array = npt.NDArray[np.float64]
TIME = 0.02 * np.arange(1500)
SPEED = 0.05 * np.sin(0.8 * TIME)
PLACE = -0.05 / 0.8 * np.cos(0.8 * TIME)
FORCE = 20.0 * np.tanh(SPEED / 1e-3) + 0.3 * np.random.default_rng(1).standard_normal(1500)


def without_speed(run: Run) -> Run:
    columns = run.columns()
    del columns["velocity_m_s"]
    return Run.from_arrays(**columns, name=run.name)  # type: ignore[arg-type]


def test_a_position_stands_for_the_speed(tmp_path: Path) -> None:
    run = Run.from_arrays(TIME, None, FORCE, position_m=np.round(PLACE, 6), name="a")
    assert "velocity_m_s" not in run.columns()
    assert np.max(np.abs(run.velocity_m_s - SPEED)[1:-1]) < 2e-4
    run.write_csv(tmp_path / "a.csv")
    again = jbf.read_run(tmp_path / "a.csv")
    assert again.columns().keys() == run.columns().keys()
    np.testing.assert_array_equal(again.velocity_m_s, run.velocity_m_s)
    (prepared,) = Campaign.prepare(Rig(), [again]).prepared
    assert [f.kind for f in prepared.examined.findings] == ["no_speed"]
    assert np.std(prepared.motion.velocity_m_s - SPEED) < 2e-5
    half = run.select(slice(0, 700))
    assert len(half.velocity_m_s) == 700
    assert "velocity_m_s" not in half.columns()


def test_an_angle_stands_for_the_speed_where_the_radius_is_known(tmp_path: Path) -> None:
    runs = make_runs(kinds=("sine_w0.5", "sine_w2.0"))
    bare = [without_speed(run) for run in runs]
    for run in bare:
        assert np.isnan(run.velocity_m_s).all()
        run.write_csv(tmp_path / f"{run.name}.csv")
    read = jbf.read_runs(tmp_path)
    model = Model(Rig.thesis(), parameters=LAW)
    for run, own in zip(runs, read, strict=True):
        np.testing.assert_allclose(model.predict(own), model.predict(run), atol=0.3)
    told = jbf.fit(Rig.thesis(), read)
    known = jbf.fit(Rig.thesis(), runs)
    assert told.rms_n == pytest.approx(known.rms_n, rel=0.02)
    assert [f.kind for f in told.findings] == ["no_speed", "no_speed"]
    assert jbf.compare(model, read).rms_n == pytest.approx(jbf.compare(model, runs).rms_n, rel=0.02)


def test_an_angle_alone_is_refused_without_a_radius() -> None:
    run = Run.from_arrays(TIME, None, FORCE, angle_rad=PLACE, name="a")
    with pytest.raises(InputError, match=r"a, column velocity_m_s: .*radius; .*\[bearing\]"):
        Campaign.prepare(Rig(), [run])


def test_no_motion_at_all_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no position tells the motion; give one of velocity_m_s"):
        Run.from_arrays(TIME, None, FORCE)
    (tmp_path / "a.csv").write_text("time_s,friction_n\n" + "".join(f"{i},1\n" for i in range(20)))
    with pytest.raises(InputError, match="column velocity_m_s: is missing"):
        jbf.read_run(tmp_path / "a.csv")
