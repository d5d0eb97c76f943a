"""Prediction against reference values computed by another integrator, and model files."""

from __future__ import annotations

import warnings
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import InputError, Model, Rig, Run, _core
from jbf.cli import main
from jbf.models.catalogue import effects

TABLE_4_2 = {"f_m": 0.26, "U_tr": 0.06, "K0": 7.5e5, "gamma": 33.0}

# Time (s) and friction coefficient for U = 0.127 sin(t), thesis clock, order 8 at rtol 1e-13.
REFERENCE = [
    (0.0628318530717959, 0.00184398115947),
    (0.125663706143592, 0.005914401230398),
    (0.188495559215388, 0.01111386120857),
    (0.251327412287183, 0.016243532861),
]


def sine_run(omega: float = 1.0, duration_s: float = 12.0) -> Run:
    """A noiseless two-way sine, finely sampled."""
    t = np.arange(0.0, duration_s, 0.002)
    return Run.from_arrays(
        t,
        0.127 * np.sin(omega * t),
        angle_rad=0.127 / omega * (1.0 - np.cos(omega * t)) / 0.0127,
        load_n=np.full(len(t), 104.0),
    )


def test_prediction_meets_the_reference() -> None:
    run = sine_run()
    force = Model(Rig.thesis(), parameters=TABLE_4_2, clock="thesis").predict(run)
    for time, f in REFERENCE:
        assert np.interp(time, run.time_s, force) / 104.0 == pytest.approx(f, abs=2e-5)


def test_load_in_the_record_wins_over_the_rig() -> None:
    run = sine_run()
    heavy = Model(Rig.thesis("4.2"), parameters=TABLE_4_2).predict(run)
    light_rig = Rig.thesis("4.3")
    same = Model(light_rig, parameters=TABLE_4_2).predict(run)
    np.testing.assert_allclose(heavy, same, rtol=1e-9, atol=1e-9)
    without = Run.from_arrays(run.time_s, run.velocity_m_s, angle_rad=run.angle_rad)
    light = Model(light_rig, parameters=TABLE_4_2).predict(without)
    built_for_it = Model(light_rig, parameters=TABLE_4_2).predict(
        Run.from_arrays(
            run.time_s,
            run.velocity_m_s,
            angle_rad=run.angle_rad,
            load_n=np.full(len(run), 83.5),
        )
    )
    np.testing.assert_array_equal(light, built_for_it)
    assert not np.allclose(light, heavy, rtol=1e-2)


def test_steady_friction_is_the_stribeck_curve() -> None:
    model = Model(Rig.thesis(), parameters=TABLE_4_2)
    f = model.steady_friction([0.001, 0.02, 0.127, -0.02]) / 104.0
    np.testing.assert_allclose(f[:2], [0.21635118264163442, 0.05782937675212433], rtol=1e-9)
    assert f[2] == pytest.approx(0.0086, abs=1e-4)
    assert f[3] == -f[1]


def test_a_saved_model_predicts_the_same_bits(tmp_path: Path) -> None:
    values = TABLE_4_2 | {"presliding.sigma": 1234.5678901234567, "sensor_lag.tau": 0.1 + 0.2}
    model = Model(Rig.thesis(), effects=["sensor_lag", "presliding"], parameters=values)
    model.save(tmp_path / "m.toml")
    again = Model.load(tmp_path / "m.toml")
    assert again == model
    run = sine_run()
    np.testing.assert_array_equal(model.predict(run), again.predict(run))


def test_effects_stand_in_the_order_of_the_chain() -> None:
    model = Model(Rig.thesis(), effects=["sensor_lag", "coulomb_drag", "drive_compliance"])
    assert model.effects == ("drive_compliance", "coulomb_drag", "sensor_lag")


def test_bad_models_are_refused() -> None:
    with pytest.raises(InputError, match="did you mean"):
        Model(Rig.thesis(), effects=["sensor_leg"])
    with pytest.raises(InputError, match="no parameter"):
        Model(Rig.thesis(), parameters={"fm": 0.2})
    with pytest.raises(InputError, match="out of range"):
        Model(Rig.thesis(), parameters={"f_m": -0.2})
    with pytest.raises(InputError, match="no law"):
        Model(Rig.thesis(), law="magic")
    no_angle = Run.from_arrays(np.arange(20.0), np.full(20, 0.1))
    with pytest.raises(InputError, match="angle_rad"):
        Model(Rig.thesis(), effects=["position_ripple"]).predict(no_angle)


STAGES = ("drive", "lubricant", "film", "contact", "other friction", "instrument")


def test_the_catalogue_is_in_the_order_of_the_chain_and_its_pages_are_full() -> None:
    stages = [STAGES.index(effect.stage) for effect in effects().values()]
    assert stages == sorted(stages)
    assert set(stages) == set(range(len(STAGES)))
    for effect in effects().values():
        assert effect.equation
        assert effect.source
        assert effect.limits
        assert effect.parameters
        for p in effect.parameters:
            assert p.lower < p.upper
            assert all(p.lower <= s <= p.upper for s in p.starts)


def test_arrays_that_make_no_motion_are_refused() -> None:
    ok = np.arange(5.0)
    with pytest.raises(ValueError, match="does not rise"):
        _core.Motion(ok[::-1].copy(), ok, ok, ok, ok + 1.0)
    with pytest.raises(ValueError, match=r"load_n\[0\]"):
        _core.Motion(ok, ok, ok, ok, ok)
    with pytest.raises(ValueError, match="has 4 values"):
        _core.Motion(ok, ok[:4].copy(), ok, ok, ok + 1.0)


def test_version_is_told() -> None:
    assert jbf.__version__ == _core.__version__


def test_a_film_too_fast_to_follow_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = sine_run(duration_s=1.0)
    usual = Model(Rig.thesis("4.2"), parameters=TABLE_4_2)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        usual.predict(run)
    # It would carry the load at a thousand times the speed of the record.
    fast = Model(Rig.thesis("4.2"), parameters={**TABLE_4_2, "U_tr": 100.0})
    with pytest.warns(jbf.FilmWarning, match="U_tr_m_s, K0 and the load"):
        friction = fast.predict(run)
    assert np.all(np.isfinite(friction))
    fast.save(tmp_path / "fast.toml")
    run.write_csv(tmp_path / "run.csv")
    files = [str(tmp_path / name) for name in ("fast.toml", "run.csv", "out.csv")]
    assert main(["predict", *files[:2], "--out", files[2]]) == 0
    said = capsys.readouterr().err
    assert said.startswith("jbf: the film of this model answers at ")
    assert said.count("\n") == 1
