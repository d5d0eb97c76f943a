"""Laws of one's own: a function in the place of a law of the catalogue."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import jbf
import numpy as np
import pytest
from jbf import InputError, Parameter, Rig, Run, export
from jbf.cli import main

NOISE_N = 0.05
TRUE = {"F_c_n": 3.0, "v_0_m_s": 0.004, "F_v_n_s_m": 25.0}
PARAMETERS = [
    Parameter("F_c_n", "N", lower=0.0, upper=1e3, starts=(5.0,)),
    Parameter("v_0_m_s", "m/s", lower=1e-5, upper=1.0, starts=(1e-3,), log=True),
    Parameter("F_v_n_s_m", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
]
MINE = """
import jbf
import numpy as np


def smooth_coulomb(velocity_m_s, F_c_n, v_0_m_s, F_v_n_s_m):
    return F_c_n * np.tanh(velocity_m_s / v_0_m_s) + F_v_n_s_m * velocity_m_s


jbf.register_law(
    smooth_coulomb,
    parameters=[
        jbf.Parameter("F_c_n", "N", lower=0.0, upper=1e3, starts=(5.0,)),
        jbf.Parameter("v_0_m_s", "m/s", lower=1e-5, upper=1.0, starts=(1e-3,), log=True),
        jbf.Parameter("F_v_n_s_m", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
    ],
)
"""


def smooth_coulomb(
    velocity_m_s: np.ndarray, F_c_n: float, v_0_m_s: float, F_v_n_s_m: float
) -> np.ndarray:
    """Coulomb friction without a jump."""
    return F_c_n * np.tanh(velocity_m_s / v_0_m_s) + F_v_n_s_m * velocity_m_s


@pytest.fixture
def law() -> Iterator[str]:
    yield jbf.register_law(smooth_coulomb, parameters=PARAMETERS).name
    jbf.forget_law("smooth_coulomb")


def runs(mass_kg: float = 0.0, zero_n: float = 0.0) -> list[Run]:
    found = []
    for k, (top, period) in enumerate([(0.01, 4.0), (0.1, 3.0), (0.05, 2.5)]):
        t = np.arange(0.0, 20.0, 0.01)
        omega = 2.0 * np.pi / period
        v, a = top * np.sin(omega * t), top * omega * np.cos(omega * t)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        force = smooth_coulomb(v, **TRUE) + mass_kg * a + zero_n + noise
        found.append(Run.from_arrays(t, v, force, name=f"run {k}"))
    return found


def test_a_prediction_is_the_function(law: str) -> None:
    (run, *_) = runs()
    model = jbf.Model(Rig(), law=law, parameters=TRUE)
    np.testing.assert_allclose(
        model.predict(run), smooth_coulomb(run.velocity_m_s, **TRUE), rtol=0.0, atol=2e-4
    )
    v = np.array([-0.1, -1e-3, 2e-3, 0.05])
    np.testing.assert_array_equal(model.steady_friction(v), smooth_coulomb(v, **TRUE))


def test_a_law_that_gives_nothing_is_nothing(law: str) -> None:
    """The core's law that carries the effects leaves no force of its own."""
    (run, *_) = runs()
    none = {"F_c_n": 0.0, "F_v_n_s_m": 0.0}
    assert np.max(np.abs(jbf.Model(Rig(), law=law, parameters=none).predict(run))) == 0.0
    only = {"inertia_leak.m_e_kg": 2.0}
    model = jbf.Model(Rig(), law=law, effects=["inertia_leak"], parameters=none | only)
    motion = np.gradient(run.velocity_m_s, run.time_s)
    np.testing.assert_allclose(model.predict(run)[5:-5], 2.0 * motion[5:-5], atol=2e-3)


def test_derivatives_are_those_of_the_predictions(law: str) -> None:
    from jbf.estimation.campaign import Campaign
    from jbf.models.chain import chain

    campaign = Campaign.prepare(Rig(), runs())
    core = chain(Rig(), law, "journal", ["inertia_leak", "sensor_lag"])
    assert core.parameter_names[:3] == list(TRUE)
    values = np.array([3.0, 0.004, 25.0, 1.5, 0.03])
    assert len(core.parameter_names) == len(values)
    rows = core.jacobian(values, campaign.motions, range(5))
    for k, name in enumerate(core.parameter_names):
        step = 1e-5 * values[k]
        up, down = values.copy(), values.copy()
        up[k] += step
        down[k] -= step
        highs, lows = (core.predict(v, campaign.motions) for v in (up, down))
        for (_, slopes), high, low in zip(rows, highs, lows, strict=True):
            quotient = (high - low) / (2.0 * step)
            size = np.max(np.abs(quotient))
            np.testing.assert_allclose(slopes[:, k], quotient, atol=1e-5 * size, err_msg=name)


def test_a_fit_finds_what_the_data_hold(law: str, tmp_path: Path) -> None:
    fit = jbf.fit(Rig(), runs(mass_kg=2.0), ["inertia_leak"], law=law)
    for name, value in (TRUE | {"inertia_leak.m_e_kg": 2.0}).items():
        found = fit.parameters[name]
        assert found.stderr is not None
        assert abs(found.value - value) < 4.0 * found.stderr
    assert fit.rms_n == pytest.approx(NOISE_N, rel=0.05)
    path = tmp_path / "m.toml"
    fit.model.save(path)
    (run, *_) = runs()
    np.testing.assert_array_equal(jbf.Model.load(path).predict(run), fit.model.predict(run))
    jbf.forget_law(law)
    with pytest.raises(InputError, match="smooth_coulomb"):
        jbf.Model.load(path)
    jbf.register_law(smooth_coulomb, parameters=PARAMETERS)


def test_what_is_missing_beside_it_is_named(law: str) -> None:
    found = jbf.diagnose(Rig(), runs(mass_kg=2.0, zero_n=0.7), law=law)
    assert (found.verdict, set(found.effects)) == ("missing", {"inertia_leak", "sensor_offset"})
    assert jbf.diagnose(Rig(), runs(), law=law).verdict == "adequate"


def test_the_data_may_choose_it(law: str) -> None:
    found = jbf.diagnose(Rig(), runs(), law="auto")
    assert (found.model.law, found.effects) == (law, ())


def test_effects_in_a_laws_parts_do_not_go_with_it(law: str) -> None:
    with pytest.raises(InputError, match="is one of your own, and the effect changes parts"):
        jbf.Model(Rig(), law=law, effects=["presliding"])
    with pytest.raises(InputError, match="does not apply: the law smooth_coulomb"):
        jbf.Model(Rig(), law=law, effects=["coulomb_drag"])


def test_no_target_runs_it(law: str) -> None:
    model = jbf.Model(Rig(), law=law, parameters=TRUE)
    with pytest.raises(InputError, match="is written in Python, which no target runs"):
        export.rust(model)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"name": "lugre"}, 'the law "lugre" is in the catalogue already'),
        ({"name": "auto"}, "has no proper name"),
        ({"name": "my law"}, "has no proper name"),
        ({"parameters": PARAMETERS[:2]}, "takes|does not take|F_v_n_s_m"),
        ({"parameters": [Parameter("F_c_n", "N", starts=(1.0,))]}, "without bounds"),
    ],
)
def test_what_is_no_law_is_one_line(options: dict, says: str) -> None:
    given = {"parameters": PARAMETERS} | options
    if given["parameters"] == PARAMETERS[:2]:
        # What is no parameter is a column, and no run has one of that name.
        page = jbf.register_law(smooth_coulomb, **given)
        with pytest.raises(InputError, match="column F_v_n_s_m: is missing, and the law"):
            jbf.Model(Rig(), law=page.name).predict(runs()[0])
        jbf.forget_law(page.name)
        return
    with pytest.raises(InputError, match=says):
        jbf.register_law(smooth_coulomb, **given)
    with pytest.raises(InputError, match="is no law of your own"):
        jbf.forget_law("smooth_coulomb")


def test_the_command_line_takes_a_file_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    (tmp_path / "rig.toml").write_text("")
    files = []
    for run in runs():
        files.append(str(tmp_path / f"{run.name.replace(' ', '_')}.csv"))
        run.write_csv(files[-1])
    mine = ["--effects-from", str(tmp_path / "mine.py")]
    out = tmp_path / "m.toml"
    asked = ["fit", str(tmp_path / "rig.toml"), *files, "--law", "smooth_coulomb"]
    try:
        assert main([*asked, "--out", str(out), *mine]) == 0
        assert main(["compare", str(out), *files, *mine]) == 0
        assert main(["effects", "--law", "smooth_coulomb", *mine]) == 0
        assert "inertia_leak" in capsys.readouterr().out
    finally:
        jbf.forget_law("smooth_coulomb")
    assert main([*asked, "--out", str(out)]) == 2
