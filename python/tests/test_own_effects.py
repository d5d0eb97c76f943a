"""Effects of one's own: a function of recorded columns in fit, comparison, diagnosis, files."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import jbf
import numpy as np
import pytest
from campaigns import campaign
from conftest import make_runs
from jbf import InputError, Model, Parameter, Rig, Run, _core
from jbf.cli import main
from jbf.models import catalogue
from jbf.models.chain import chain, core_motion, imposed
from jbf.models.own_chain import BENDING

HEAT = Parameter("k_n_k", "N/K", lower=-5.0, upper=5.0, null=0.0, starts=(0.1,))
TRUTH = 0.35


def cooler(temperature_c: np.ndarray, velocity_m_s: np.ndarray, k_n_k: float) -> np.ndarray:
    """A seal that grips as it warms."""
    return k_n_k * (temperature_c - 40.0) * np.tanh(velocity_m_s / 0.01)


@pytest.fixture(autouse=True)
def _clean() -> Iterator[None]:
    yield
    for name in list(catalogue.own()):
        jbf.forget_effect(name)


def warm(run: Run, seed: int, size: float = TRUTH) -> Run:
    """The run with a temperature and the cooler's force on its friction."""
    t = run.time_s
    celsius = 42.0 + 2.0 * np.sin(0.7 * t + seed) + 0.05 * t
    force = cooler(celsius, run.velocity_m_s, size)
    assert run.friction_n is not None
    return Run.from_arrays(
        t,
        run.velocity_m_s,
        run.friction_n + force,
        angle_rad=run.angle_rad,
        load_n=run.load_n,
        temperature_c=celsius,
        extra={"humidity": 0.5 + 0.1 * np.cos(t)},
        name=run.name,
    )


def test_it_is_fitted_compared_and_diagnosed() -> None:
    rig, runs, truth = campaign(34)
    runs = [warm(run, i) for i, run in enumerate(runs)]
    jbf.register_effect(cooler, parameters=[HEAT])
    fitted = jbf.fit(rig, runs, ["cooler"])
    found = fitted.parameters["cooler.k_n_k"]
    assert found.stderr is not None
    assert abs(found.value - TRUTH) < 4.0 * found.stderr < 0.1
    assert fitted.rms_n < 1.03 * truth["noise_n"]
    assert jbf.compare(fitted.model, runs).rms_n == pytest.approx(fitted.rms_n)
    d = jbf.diagnose(rig, runs)
    assert d.effects == ("cooler",)
    assert d.verdict == "missing"


def test_it_is_no_candidate_where_its_column_is_missing() -> None:
    rig, runs = Rig.thesis(), make_runs({"coulomb_drag": {"F_d_n": 2.0}})
    jbf.register_effect(cooler, parameters=[HEAT])
    d = jbf.diagnose(rig, runs)
    assert d.effects == ("coulomb_drag",)
    assert d.not_tried["cooler"] == "not every run has the column temperature_c"
    with pytest.raises(InputError, match="column temperature_c: is missing, and the effect cooler"):
        jbf.fit(rig, runs, ["cooler"])


def _slopes(effects: list[str], values: np.ndarray, run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives from the chain, and by central differences."""
    rig = Rig.thesis()
    core = chain(rig, "journal", "journal", effects)
    motion = core_motion(rig, run, imposed(rig, run))
    [(_, slopes)] = core.jacobian(values, [motion], list(range(len(values))))
    found = np.empty_like(slopes)
    for i in range(len(values)):
        h = 1e-5 * max(abs(values[i]), 1e-3)
        up, down = values.copy(), values.copy()
        up[i] += h
        down[i] -= h
        found[:, i] = (core.predict(up, [motion])[0] - core.predict(down, [motion])[0]) / (2 * h)
    return slopes, found


@pytest.mark.parametrize("stage", ["other", "instrument"])
def test_derivatives_go_through_the_instrument(stage: str) -> None:
    run = warm(make_runs()[0], 0)
    jbf.register_effect(cooler, parameters=[HEAT], stage=stage)
    effects = ["sensor_lag", "time_delay", "sensor_offset", "cooler"]
    values = np.array([0.26, 0.055, 6.5e5, 33.0, 0.12, 0.0233, 0.4, TRUTH])
    slopes, found = _slopes(effects, values, run)
    scale = np.max(np.abs(found), axis=0)
    assert np.all(scale > 0.0)
    assert np.max(np.abs(slopes - found) / scale) < 1e-5


def _held(force: np.ndarray, w_n: float) -> np.ndarray:
    """A reading that the force takes along at the ends of a gap of half width `w_n`."""
    found = [float(force[0])]
    for f in force[1:].tolist():
        found.append(min(max(found[-1], f - w_n), f + w_n))
    return np.array(found)


@pytest.mark.parametrize(
    ("effect", "value", "read"),
    [
        ("sensor_nonlinearity.c_1_n2", -4e-4, lambda f: f - 4e-4 * f**3),
        ("sensor_hysteresis.w_n", 0.7, lambda f: _held(f, 0.7)),
    ],
)
def test_a_cell_that_bends_sees_the_whole_force(
    effect: str, value: float, read: Callable[[np.ndarray], np.ndarray]
) -> None:
    run = warm(make_runs()[0], 0)
    jbf.register_effect(cooler, parameters=[HEAT])
    own, name = {"cooler.k_n_k": 2.0}, effect.split(".")[0]
    force = Model(Rig.thesis(), effects=["cooler"], parameters=own).predict(run)
    both = Model(Rig.thesis(), effects=[name, "cooler"], parameters={**own, effect: value})
    plain = Model(Rig.thesis(), effects=[name], parameters={effect: value}).predict(run)
    got, expected = both.predict(run), read(force)
    # The play knows a peak between two samples.
    np.testing.assert_allclose(got, expected, atol=1e-2 if name == "sensor_hysteresis" else 1e-6)
    # Not what the cell makes of either force by itself.
    alone = Model(Rig.thesis(), effects=[]).predict(run)
    assert np.max(np.abs(plain + force - alone - got)) > 0.1
    values = np.array([0.26, 0.055, 6.5e5, 33.0, value, 2.0])
    slopes, found = _slopes([name, "cooler"], values, run)
    wrong = np.abs(slopes - found) > 1e-4 * np.max(np.abs(found), axis=0)
    # A difference looks across a kink where the force turns round.
    assert np.max(np.mean(wrong, axis=0)) < 0.02


def test_every_effect_of_the_instrument_that_bends_is_known() -> None:
    """What the instrument makes of two forces is the sum of what it makes of each, or is told."""
    time = np.linspace(0.0, 10.0, 400)
    one, other = 8.0 * np.sin(time), 3.0 * np.cos(2.7 * time)
    for effect in catalogue.built_in().values():
        if effect.stage != "instrument":
            continue
        with_usual = [(effect.name, [p.starts[0] for p in effect.parameters])]

        def read(force: np.ndarray, chosen: list[tuple[str, list[float]]]) -> np.ndarray:
            return _core.read_force(chosen, time, force)[0]

        none = read(np.zeros_like(time), with_usual)
        whole = read(one + other, with_usual) - none
        parts = read(one, with_usual) + read(other, with_usual) - 2.0 * none
        adds_up = bool(np.max(np.abs(whole - parts)) < 1e-9)
        assert adds_up != (effect.name in BENDING), effect.name


def test_the_lag_sees_what_acts_before_it() -> None:
    run = warm(make_runs()[0], 0)

    def pull(time_s: np.ndarray, a_n: float) -> np.ndarray:
        return a_n * (time_s >= 0.0)

    page = Parameter("a_n", "N", lower=0.0, upper=9.0, null=0.0, starts=(1.0,))
    tau = {"sensor_lag.tau_s": 0.5}
    lagged = Model(Rig.thesis(), effects=["sensor_lag"], parameters=tau).predict(run)
    for stage in ("other", "instrument"):
        jbf.register_effect(pull, parameters=[page], stage=stage)
        with_pull = Model(
            Rig.thesis(), effects=["sensor_lag", "pull"], parameters={**tau, "pull.a_n": 3.0}
        ).predict(run)
        # It pulls from the start, so that the settled cell shows it whole.
        np.testing.assert_allclose(with_pull - lagged, 3.0, atol=1e-9)

    def ramped(time_s: np.ndarray, s_n_s: float) -> np.ndarray:
        return s_n_s * time_s

    slope = Parameter("s_n_s", "N/s", lower=0.0, upper=9.0, null=0.0, starts=(1.0,))
    jbf.register_effect(ramped, parameters=[slope])
    late = Model(
        Rig.thesis(), effects=["sensor_lag", "ramped"], parameters={**tau, "ramped.s_n_s": 1.0}
    ).predict(run)
    t = run.time_s
    np.testing.assert_allclose(late - lagged, t - 0.5 * (1.0 - np.exp(-t / 0.5)), atol=1e-6)


def test_a_function_of_real_numbers_gets_differences() -> None:
    run = warm(make_runs()[0], 0)

    def stepped(velocity_m_s: np.ndarray, a_n: float, v_m_s: float) -> np.ndarray:
        out = np.zeros(len(velocity_m_s))
        out += abs(a_n) * np.exp(-np.abs(velocity_m_s) / abs(v_m_s))  # refuses complex numbers
        return out

    pages = [
        Parameter("a_n", "N", lower=0.0, upper=9.0, null=0.0, starts=(1.0,)),
        Parameter("v_m_s", "m/s", lower=1e-3, upper=1.0, starts=(0.02,), log=True),
    ]
    effect = jbf.register_effect(stepped, parameters=pages)
    assert isinstance(effect, jbf.models.own_effects.OwnEffect)
    slopes, found = _slopes(["stepped"], np.array([0.26, 0.055, 6.5e5, 33.0, 1.5, 0.03]), run)
    assert np.max(np.abs(slopes - found)[:, 4:] / np.max(np.abs(found), axis=0)[4:]) < 1e-6
    assert effect.analytic == {"a_n": False, "v_m_s": False}
    # At the lower bound, from inside.
    columns = {"velocity_m_s": run.velocity_m_s, "time_s": run.time_s}
    edge = effect.slope(columns, [0.0, 0.03], 0)
    np.testing.assert_allclose(edge, np.exp(-np.abs(run.velocity_m_s) / 0.03), rtol=1e-9)


def test_complex_step_is_exact() -> None:
    effect = jbf.register_effect(cooler, parameters=[HEAT])
    assert isinstance(effect, jbf.models.own_effects.OwnEffect)
    columns = {"temperature_c": np.array([41.0, 45.0]), "velocity_m_s": np.array([0.1, -0.01])}
    columns["time_s"] = np.arange(2.0)
    expected = np.array([1.0, 5.0]) * np.tanh(np.array([10.0, -1.0]))
    np.testing.assert_allclose(effect.slope(columns, [0.2], 0), expected, rtol=1e-15)
    assert effect.analytic == {"k_n_k": True}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "coulomb_drag"}, "is in the catalogue already"),
        ({"name": "no name"}, "has no proper name"),
        ({"stage": "film"}, 'cannot act at the stage "film"; choose other or instrument'),
        ({"parameters": []}, "has no parameters"),
        ({"parameters": [Parameter("k_n_k", starts=(0.1,))]}, "without bounds"),
        ({"parameters": [Parameter("k_n_k", lower=0, upper=1, null=0)]}, "starting value"),
        ({"parameters": [Parameter("k_n_k", lower=0, upper=1, starts=(0.5,))]}, "never vanishes"),
        ({"parameters": [HEAT, Parameter("b", lower=0, upper=1, starts=(0.5,))]}, "parameter b"),
        ({"parameters": [HEAT, HEAT]}, "two parameters of one name"),
    ],
)
def test_a_wrong_registration_is_refused(change: dict[str, object], message: str) -> None:
    good: dict[str, object] = {"parameters": [HEAT]}
    with pytest.raises(InputError, match=message):
        jbf.register_effect(cooler, **(good | change))  # type: ignore[arg-type]
    assert not catalogue.own()


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (lambda time_s, a: a * time_s[:-1], "gives shape"),
        (lambda time_s, a: a / (time_s * 0.0), "gives (nan|inf|-inf) at sample 0 with a = 0.5"),
        (lambda time_s, a: str(a), "gives <U"),
        (lambda time_s, a: {}[a], "the effect bad fails: KeyError"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
@pytest.mark.filterwarnings("ignore:invalid value")
def test_a_bad_function_is_one_line(body: object, message: str) -> None:
    page = Parameter("a", lower=-1.0, upper=1.0, null=0.0, starts=(0.5,))
    jbf.register_effect(body, name="bad", parameters=[page])  # type: ignore[arg-type]
    model = Model(Rig.thesis(), effects=["bad"], parameters={"bad.a": 0.5})
    with pytest.raises(InputError, match=message):
        model.predict(make_runs()[0])


FILE = """
import numpy as np
import jbf


def cooler(temperature_c, velocity_m_s, k_n_k):
    \"\"\"A seal that grips as it warms.\"\"\"
    return k_n_k * (temperature_c - 40.0) * np.tanh(velocity_m_s / 0.01)


jbf.register_effect(
    cooler,
    parameters=[jbf.Parameter("k_n_k", "N/K", lower=-5, upper=5, null=0.0, starts=(0.1,))],
)
"""


def test_the_command_line_takes_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mine.py").write_text(FILE)
    Rig.thesis().write(tmp_path / "rig.toml")
    for i, run in enumerate(make_runs()):
        warm(run, i).write_csv(tmp_path / f"{run.name}.csv")
    own = ["--effects-from", str(tmp_path / "mine.py")]
    rig, model = str(tmp_path / "rig.toml"), str(tmp_path / "m.toml")
    runs = [str(tmp_path / "*.csv")]
    assert main(["effects", *own]) == 0
    assert "[your own, other friction]" in capsys.readouterr().out
    assert main(["effects", "cooler", *own, "--json", str(tmp_path / "page.json")]) == 0
    assert "temperature_c" in capsys.readouterr().out
    assert main(["fit", rig, *runs, "--effects", "cooler", "--out", model, *own]) == 0
    assert "cooler.k_n_k" in capsys.readouterr().out
    assert main(["compare", model, *runs, *own]) == 0
    capsys.readouterr()
    jbf.forget_effect("cooler")
    assert main(["compare", model, *runs]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert '"cooler" is not known' in line
    assert "--effects-from" in line


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import jbf\n\n1 / 0\n", "row 3: fails: ZeroDivisionError"),
        ("def f(:\n", "row 1: fails: SyntaxError"),
        ("x = 1\n", "registers no effect"),
    ],
)
def test_a_bad_file_is_one_line(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bad.py").write_text(text)
    assert main(["effects", "--effects-from", str(tmp_path / "bad.py")]) == 2
    line = capsys.readouterr().err
    assert message in line
    assert line.count("\n") == 1
    assert main(["effects", "--effects-from", str(tmp_path / "none.py")]) == 2
    assert "is no file" in capsys.readouterr().err


def test_columns_of_the_record_reach_the_function() -> None:
    seen: dict[str, np.ndarray] = {}

    def look(humidity: np.ndarray, load_n: np.ndarray, angle_rad: np.ndarray, a: float) -> float:
        seen.update(humidity=humidity, load_n=load_n, angle_rad=angle_rad)
        return 0.0 * a

    page = Parameter("a", lower=-1.0, upper=1.0, null=0.0, starts=(0.5,))
    jbf.register_effect(look, parameters=[page])
    run = warm(make_runs()[0], 0)
    Model(Rig.thesis(), effects=["look"], parameters={"look.a": 0.5}).predict(run)
    np.testing.assert_array_equal(seen["humidity"], run.extra["humidity"])
    np.testing.assert_array_equal(seen["load_n"], np.full(len(run), 104.0))
    assert run.angle_rad is not None
    assert np.max(np.abs(seen["angle_rad"] - run.angle_rad)) < 1e-3


def test_the_page_runs_as_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = Path(__file__).resolve().parents[2] / "docs" / "own_effects.md"
    text = page.read_text(encoding="utf-8")
    own, *snippets = re.findall(r"```python[^\n]*\n(.*?)```", text, re.DOTALL)
    assert len(snippets) == 2
    (tmp_path / "mine.py").write_text(own)
    Rig.thesis().write(tmp_path / "rig.toml")
    (tmp_path / "runs").mkdir()
    for i, run in enumerate(make_runs({"coulomb_drag": {"F_d_n": 2.0}})):
        warm(run, i).write_csv(tmp_path / "runs" / f"{run.name}.csv")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for snippet in snippets:
        exec(compile(snippet, page.name, "exec"), names)
    found = names["again"]
    assert isinstance(found, Model)
    value = found.parameters["warm_seal.k_n_k"]
    assert isinstance(value, jbf.ParameterValue)
    assert value.stderr is not None
    assert abs(value.value - TRUTH) < 4.0 * value.stderr
