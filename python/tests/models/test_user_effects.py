"""User-defined effects: a Python function of recorded columns in fit, diagnosis and files."""

import inspect
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from by_hand import coulomb, four_runs
from campaigns import campaign
from conftest import make_runs
from input_checks import Capture
from input_errors import input_error
from jbf import InputError, Model, Parameter, Rig, Run, export
from jbf.cli import main
from jbf.models import catalogue
from jbf.models.chain import chain, core_motion, estimated_motion
from jbf.models.user_chain import NONLINEAR_EFFECTS

HEAT = Parameter("k_n_k", "N/K", lower=-5.0, upper=5.0, null=0.0, starts=(0.1,))
TRUTH = 0.35


def cooler(temperature_c: np.ndarray, velocity: np.ndarray, k_n_k: float) -> np.ndarray:
    """Friction of a seal that grows with the temperature."""
    return k_n_k * (temperature_c - 40.0) * np.tanh(velocity / 0.01)


@pytest.fixture(autouse=True)
def forget() -> Iterator[None]:
    yield
    for name in list(catalogue.user_effects()):
        jbf.forget_effect(name)


def with_cooler(run: Run, seed: int) -> Run:
    """The run with a temperature column and with the force of the cooler added to its friction."""
    t = run.time_s
    celsius = 42.0 + 2.0 * np.sin(0.7 * t + seed) + 0.05 * t
    force = cooler(celsius, run.velocity, TRUTH)
    extra = {"humidity": 0.5 + 0.1 * np.cos(t)}
    return replace(run, friction=run.friction + force, temperature_c=celsius, extra=extra)


def predicted(run: Run, effects: list[str], values: dict[str, float]) -> np.ndarray:
    """Force (N) predicted by a model of the thesis with the given effects."""
    return Model(Rig.thesis(), effects=effects, parameters=values).predict(run)


def cooler_campaign() -> tuple[Rig, list[Run], float]:
    """A simulated campaign with the cooler as the only effect, and its noise (N)."""
    rig, runs, truth = campaign(34)
    return rig, [with_cooler(run, i) for i, run in enumerate(runs)], truth["noise_n"]


def test_fit_recovers_the_parameter_of_a_user_effect_and_compare_reports_its_rms() -> None:
    rig, runs, noise_rms = cooler_campaign()
    jbf.register_effect(cooler, parameters=[HEAT])
    fitted = jbf.fit(rig, runs, ["cooler"])
    result = fitted.parameters["cooler.k_n_k"]
    assert abs(result.value - TRUTH) < 4.0 * result.stderr < 0.1
    assert fitted.rms < 1.03 * noise_rms
    assert jbf.compare(fitted.model, runs).rms == pytest.approx(fitted.rms)


@pytest.mark.extended
def test_diagnosis_identifies_a_user_effect_that_generated_the_data() -> None:
    rig, runs, _ = cooler_campaign()
    jbf.register_effect(cooler, parameters=[HEAT])
    diagnosis = jbf.diagnose(rig, runs)
    assert (diagnosis.verdict, diagnosis.effects) == ("missing", ("cooler",))


@pytest.mark.extended
def test_diagnosis_does_not_try_a_user_effect_whose_column_is_missing() -> None:
    jbf.register_effect(cooler, parameters=[HEAT])
    diagnosis = jbf.diagnose(Rig(), four_runs(coulomb, noise_rms=0.1), law="coulomb")
    assert "temperature_c" in diagnosis.not_tried["cooler"]


def test_fit_of_a_user_effect_is_refused_if_its_column_is_missing() -> None:
    jbf.register_effect(cooler, parameters=[HEAT])
    runs = four_runs(coulomb, noise_rms=0.1)
    error = input_error(jbf.fit, Rig(), runs, ["cooler"], law="coulomb")
    assert error.column == "temperature_c"
    assert "cooler" in str(error)


def test_export_of_a_model_with_a_user_effect_is_refused() -> None:
    jbf.register_effect(cooler, parameters=[HEAT])
    error = input_error(export.rust, Model(Rig.thesis(), effects=["cooler"]))
    assert "cooler" in str(error)


def slopes_of(effects: list[str], values: np.ndarray, run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Return the Jacobian of the chain and its approximation by central differences."""
    rig = Rig.thesis()
    core = chain(rig, "journal", "journal", effects)
    motion = core_motion(rig, run, estimated_motion(rig, run))
    [(_, slopes)] = core.jacobian(values, [motion], list(range(len(values))))
    result = np.empty_like(slopes)
    for i, step in enumerate(np.diag(1e-5 * np.maximum(np.abs(values), 1e-3))):
        high, low = (core.predict(values + s, [motion])[0] for s in (step, -step))
        result[:, i] = (high - low) / (2.0 * step[i])
    return slopes, result


@pytest.mark.parametrize("stage", ["other", "instrument"])
def test_jacobian_of_user_and_sensor_effects_agrees_with_difference_quotients(stage: str) -> None:
    run = with_cooler(make_runs()[0], 0)
    jbf.register_effect(cooler, parameters=[HEAT], stage=stage)
    effects = ["sensor_lag", "time_delay", "sensor_offset", "cooler"]
    values = np.array([0.26, 0.055, 6.5e5, 33.0, 0.12, 0.0233, 0.4, TRUTH])
    slopes, result = slopes_of(effects, values, run)
    scale = np.max(np.abs(result), axis=0)
    assert np.all(scale > 0.0)
    assert np.max(np.abs(slopes - result) / scale) < 1e-5


def play(force: np.ndarray, w_n: float) -> np.ndarray:
    """A play operator of half width `w_n`."""
    reading = [float(force[0])]
    for f in force[1:].tolist():
        reading.append(min(max(reading[-1], f - w_n), f + w_n))
    return np.array(reading)


@pytest.mark.parametrize(
    ("effect", "value", "read"),
    [
        ("sensor_nonlinearity.c", -4e-4, lambda f: f - 4e-4 * f**3),
        ("sensor_hysteresis.w", 0.7, lambda f: play(f, 0.7)),
    ],
)
def test_nonlinear_sensor_responds_to_the_sum_of_built_in_and_user_forces(
    effect: str, value: float, read: Callable[[np.ndarray], np.ndarray]
) -> None:
    run = with_cooler(make_runs()[0], 0)
    jbf.register_effect(cooler, parameters=[HEAT])
    heat, name = {"cooler.k_n_k": 2.0}, effect.split(".")[0]
    force = predicted(run, ["cooler"], heat)
    both = predicted(run, [name, "cooler"], heat | {effect: value})
    # jbf resolves peaks between two samples.
    atol = 1e-2 if name == "sensor_hysteresis" else 1e-6
    np.testing.assert_allclose(both, read(force), atol=atol)
    # The response to the sum differs from the sum of the responses.
    sum_of_responses = predicted(run, [name], {effect: value}) + force - predicted(run, [], {})
    assert np.max(np.abs(sum_of_responses - both)) > 0.1
    values = np.array([0.26, 0.055, 6.5e5, 33.0, value, 2.0])
    slopes, result = slopes_of([name, "cooler"], values, run)
    wrong = np.abs(slopes - result) > 1e-4 * np.max(np.abs(result), axis=0)
    # Difference quotients are invalid across a reversal of the force.
    assert np.max(np.mean(wrong, axis=0)) < 0.02


SIZE = Parameter("a_n", "N", lower=0.0, upper=9.0, null=0.0, starts=(1.0,))


def test_sensor_lag_filters_a_user_force_and_leaves_a_constant_one_unchanged() -> None:
    run = with_cooler(make_runs()[0], 0)

    def pull(time_s: np.ndarray, a_n: float) -> np.ndarray:
        return a_n * (time_s >= 0.0)

    tau = {"sensor_lag.tau_s": 0.5}
    lagged = predicted(run, ["sensor_lag"], tau)
    for stage in ("other", "instrument"):
        jbf.register_effect(pull, parameters=[SIZE], stage=stage)
        with_pull = predicted(run, ["sensor_lag", "pull"], tau | {"pull.a_n": 3.0})
        # The force is constant from the start, so that the sensor is settled.
        np.testing.assert_allclose(with_pull - lagged, 3.0, atol=1e-9)

    def ramped(time_s: np.ndarray, a_n: float) -> np.ndarray:
        return a_n * time_s

    jbf.register_effect(ramped, parameters=[SIZE])
    with_ramp = predicted(run, ["sensor_lag", "ramped"], tau | {"ramped.a_n": 1.0})
    t = run.time_s
    np.testing.assert_allclose(with_ramp - lagged, t - 0.5 * (1.0 - np.exp(-t / 0.5)), atol=1e-6)


def test_user_effect_without_complex_support_is_differentiated_numerically() -> None:
    run = with_cooler(make_runs()[0], 0)

    def stepped(velocity: np.ndarray, a_n: float, v_m_s: float) -> np.ndarray:
        out = np.zeros(len(velocity))
        out += abs(a_n) * np.exp(-np.abs(velocity) / abs(v_m_s))  # not defined for complex numbers
        return out

    speed = Parameter("v_m_s", "m/s", lower=1e-3, upper=1.0, starts=(0.02,), log=True)
    effect = jbf.register_effect(stepped, parameters=[SIZE, speed])
    slopes, result = slopes_of(["stepped"], np.array([0.26, 0.055, 6.5e5, 33.0, 1.5, 0.03]), run)
    assert np.max(np.abs(slopes - result)[:, 4:] / np.max(np.abs(result), axis=0)[4:]) < 1e-6
    assert effect.analytic == {"a_n": False, "v_m_s": False}
    # At the lower bound the differences are one-sided.
    edge = effect.slope({"velocity": run.velocity, "time_s": run.time_s}, [0.0, 0.03], 0)
    np.testing.assert_allclose(edge, np.exp(-np.abs(run.velocity) / 0.03), rtol=1e-9)


def test_user_effect_that_is_analytic_is_differentiated_by_a_complex_step() -> None:
    effect = jbf.register_effect(cooler, parameters=[HEAT])
    columns = {"temperature_c": np.array([41.0, 45.0]), "velocity": np.array([0.1, -0.01])}
    columns["time_s"] = np.arange(2.0)
    expected = np.array([1.0, 5.0]) * np.tanh(np.array([10.0, -1.0]))
    np.testing.assert_allclose(effect.slope(columns, [0.2], 0), expected, rtol=1e-15)
    assert effect.analytic == {"k_n_k": True}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"name": "coulomb_drag"}, "is in the catalogue already"),
        ({"name": "no name"}, "has an invalid name"),
        ({"stage": "film"}, 'cannot be at the stage "film"; choose other or instrument'),
        ({"parameters": []}, "has no parameters"),
        ({"parameters": [Parameter("k_n_k", starts=(0.1,))]}, "without bounds"),
        ({"parameters": [Parameter("k_n_k", lower=0, upper=1, null=0)]}, "starting value"),
        ({"parameters": [Parameter("k_n_k", lower=0, upper=1, starts=(0.5,))]}, "never vanishes"),
        ({"parameters": [HEAT, Parameter("b", lower=0, upper=1, starts=(0.5,))]}, "parameter b"),
        ({"parameters": [HEAT, HEAT]}, "two parameters of the same name"),
    ],
)
def test_registration_of_an_invalid_effect_is_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        jbf.register_effect(cooler, **({"parameters": [HEAT]} | change))
    assert not catalogue.user_effects()


FACTOR = Parameter("a", lower=-1.0, upper=1.0, null=0.0, starts=(0.5,))


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (lambda time_s, a: a * time_s[:-1], "returns shape"),
        (lambda time_s, a: a / (time_s * 0.0), "returns (nan|inf|-inf) at sample 0 with a = 0.5"),
        (lambda time_s, a: str(a), "gives <U"),
        (lambda time_s, a: {}[a], "the effect bad fails: KeyError"),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
@pytest.mark.filterwarnings("ignore:invalid value")
def test_invalid_result_or_exception_of_a_user_effect_is_reported(body: Any, message: str) -> None:
    jbf.register_effect(body, name="bad", parameters=[FACTOR])
    with pytest.raises(InputError, match=message):
        predicted(make_runs()[0], ["bad"], {"bad.a": 0.5})


FILE = f"""
import numpy as np
import jbf

{inspect.getsource(cooler)}
heat = jbf.Parameter("k_n_k", "N/K", lower=-5, upper=5, null=0.0, starts=(0.1,))
jbf.register_effect(cooler, parameters=[heat])
"""


def test_commands_require_an_option_to_load_a_user_effect(tmp_path: Path, capsys: Capture) -> None:
    (tmp_path / "mine.py").write_text(FILE)
    Rig.thesis().write(tmp_path / "rig.toml")
    for i, run in enumerate(make_runs()):
        with_cooler(run, i).write_csv(tmp_path / f"{run.name}.csv")
    option = ["--effects-from", str(tmp_path / "mine.py")]
    rig, model, runs = (str(tmp_path / name) for name in ("rig.toml", "m.toml", "*.csv"))
    assert main(["effects", *option]) == 0
    assert "[user-defined, other friction]" in capsys.readouterr().out
    assert main(["effects", "cooler", *option, "--json", str(tmp_path / "page.json")]) == 0
    assert "temperature_c" in capsys.readouterr().out
    assert main(["fit", rig, runs, "--effects", "cooler", "--out", model, *option]) == 0
    assert "cooler.k_n_k" in capsys.readouterr().out
    assert main(["compare", model, runs, *option]) == 0
    capsys.readouterr()
    jbf.forget_effect("cooler")
    assert main(["compare", model, runs]) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert '"cooler" is not known' in line
    assert "--effects-from" in line


def test_user_effect_receives_the_recorded_columns_that_its_arguments_name() -> None:
    seen: dict[str, np.ndarray] = {}

    def look(humidity: np.ndarray, load_n: np.ndarray, angle_rad: np.ndarray, a: float) -> float:
        seen.update(humidity=humidity, load_n=load_n, angle_rad=angle_rad)
        return 0.0 * a

    jbf.register_effect(look, parameters=[FACTOR])
    run = with_cooler(make_runs()[0], 0)
    predicted(run, ["look"], {"look.a": 0.5})
    np.testing.assert_array_equal(seen["humidity"], run.extra["humidity"])
    np.testing.assert_array_equal(seen["load_n"], np.full(len(run), 104.0))
    assert np.max(np.abs(seen["angle_rad"] - run.angle_rad)) < 1e-3


def test_table_of_nonlinear_instruments_lists_exactly_the_nonlinear_instrument_effects() -> None:
    """A linear instrument responds to a sum of forces with the sum of its responses."""
    t = np.linspace(0.0, 10.0, 400)
    run = Run.from_arrays(t, 0.1 * np.cos(t), position_m=0.1 * np.sin(t))

    def two_waves(time_s: np.ndarray, a_n: float, b_n: float) -> np.ndarray:
        return a_n * np.sin(time_s) + b_n * np.cos(2.7 * time_s)

    first = Parameter("a_n", "N", lower=-20.0, upper=20.0, null=0.0, starts=(1.0,))
    jbf.register_effect(two_waves, parameters=[first, replace(first, name="b_n")])
    for effect in (e for e in catalogue.built_in().values() if e.stage == "instrument"):
        usual = {f"{effect.name}.{p.name}": p.starts[0] for p in effect.parameters}
        nonlinearity = np.zeros(len(run))
        for sign, a_n, b_n in ((1, 8.0, 3.0), (-1, 8.0, 0.0), (-1, 0.0, 3.0), (1, 0.0, 0.0)):
            values = usual | {"two_waves.a_n": a_n, "two_waves.b_n": b_n}
            model = Model(Rig(), "coulomb", [effect.name, "two_waves"], values)
            nonlinearity += sign * model.predict(run)
        assert (np.max(np.abs(nonlinearity)) >= 1e-9) == (effect.name in NONLINEAR_EFFECTS), (
            effect.name
        )
