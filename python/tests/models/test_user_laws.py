"""User-defined laws: a Python function in place of a law of the catalogue."""

from collections.abc import Iterator
from pathlib import Path

import jbf
import numpy as np
import pytest
from input_errors import input_error
from jbf import InputError, Parameter, Rig, Run, export
from jbf.estimation.campaign import Campaign
from jbf.models.chain import chain

NOISE_N = 0.05
TRUE = {"F_c": 3.0, "v_0": 0.004, "F_v": 25.0}
PARAMETERS = [
    Parameter("F_c", "N", lower=0.0, upper=1e3, starts=(5.0,)),
    Parameter("v_0", "m/s", lower=1e-5, upper=1.0, starts=(1e-3,), log=True),
    Parameter("F_v", "N s/m", lower=0.0, upper=1e4, starts=(10.0,)),
]


def smooth_coulomb(velocity: np.ndarray, F_c: float, v_0: float, F_v: float) -> np.ndarray:
    """Coulomb friction without a jump."""
    return F_c * np.tanh(velocity / v_0) + F_v * velocity


@pytest.fixture
def law() -> Iterator[str]:
    yield jbf.register_law(smooth_coulomb, parameters=PARAMETERS).name
    jbf.forget_law("smooth_coulomb")


def runs(mass_kg: float = 0.0, zero_n: float = 0.0) -> list[Run]:
    result = []
    for k, (top, period) in enumerate([(0.01, 4.0), (0.1, 3.0), (0.05, 2.5)]):
        t = np.arange(0.0, 20.0, 0.01)
        omega = 2.0 * np.pi / period
        v, a = top * np.sin(omega * t), top * omega * np.cos(omega * t)
        noise = NOISE_N * np.random.default_rng(k).standard_normal(len(t))
        force = smooth_coulomb(v, **TRUE) + mass_kg * a + zero_n + noise
        result.append(Run.from_arrays(t, v, force, name=f"run {k}"))
    return result


def test_prediction_of_a_user_law_equals_its_function(law: str) -> None:
    (run, *_) = runs()
    model = jbf.Model(Rig(), law=law, parameters=TRUE)
    expected = smooth_coulomb(run.velocity, **TRUE)
    np.testing.assert_allclose(model.predict(run), expected, rtol=0.0, atol=2e-4)
    v = np.array([-0.1, -1e-3, 2e-3, 0.05])
    np.testing.assert_array_equal(model.steady_friction(v), smooth_coulomb(v, **TRUE))


def test_user_law_with_zero_parameters_predicts_only_the_force_of_the_effects(law: str) -> None:
    (run, *_) = runs()
    zero = {"F_c": 0.0, "F_v": 0.0}
    assert np.max(np.abs(jbf.Model(Rig(), law=law, parameters=zero).predict(run))) == 0.0
    mass = {"inertia.m_e": 2.0}
    model = jbf.Model(Rig(), law=law, effects=["inertia"], parameters=zero | mass)
    motion = np.gradient(run.velocity, run.time_s)
    np.testing.assert_allclose(model.predict(run)[5:-5], 2.0 * motion[5:-5], atol=2e-3)


def test_jacobian_of_a_user_law_agrees_with_difference_quotients(law: str) -> None:
    campaign = Campaign.prepare(Rig(), runs())
    core = chain(Rig(), law, "journal", ["inertia", "sensor_lag"])
    assert core.parameter_names[:3] == list(TRUE)
    values = np.array([3.0, 0.004, 25.0, 1.5, 0.03])
    rows = core.jacobian(values, campaign.motions, range(5))
    steps = np.diag(1e-5 * values)
    for k, (name, step) in enumerate(zip(core.parameter_names, steps, strict=True)):
        highs, lows = (core.predict(values + s, campaign.motions) for s in (step, -step))
        for (_, slopes), high, low in zip(rows, highs, lows, strict=True):
            quotient = (high - low) / (2.0 * step[k])
            size = np.max(np.abs(quotient))
            np.testing.assert_allclose(slopes[:, k], quotient, atol=1e-5 * size, err_msg=name)


def test_parameters_of_a_user_law_and_of_an_effect_are_recovered(law: str) -> None:
    fit = jbf.fit(Rig(), runs(mass_kg=2.0), ["inertia"], law=law)
    for name, value in (TRUE | {"inertia.m_e": 2.0}).items():
        result = fit.parameters[name]
        assert abs(result.value - value) < 4.0 * result.stderr
    assert fit.rms == pytest.approx(NOISE_N, rel=0.05)


def test_model_of_a_user_law_can_be_loaded_only_if_registered(law: str, tmp_path: Path) -> None:
    parameters = TRUE | {"inertia.m_e": 2.0}
    model = jbf.Model(Rig(), law=law, effects=["inertia"], parameters=parameters)
    path = tmp_path / "m.toml"
    model.save(path)
    (run, *_) = runs()
    np.testing.assert_array_equal(jbf.Model.load(path).predict(run), model.predict(run))
    jbf.forget_law(law)
    with pytest.raises(InputError, match="smooth_coulomb"):
        jbf.Model.load(path)
    jbf.register_law(smooth_coulomb, parameters=PARAMETERS)


@pytest.mark.extended
def test_diagnosis_with_a_user_law_identifies_the_missing_effects(law: str) -> None:
    result = jbf.diagnose(Rig(), runs(mass_kg=2.0, zero_n=0.7), law=law)
    assert (result.verdict, set(result.effects)) == ("missing", {"inertia", "sensor_offset"})


@pytest.mark.extended
def test_automatic_law_selection_chooses_the_user_law_that_generated_the_data(law: str) -> None:
    result = jbf.diagnose(Rig(), runs(), law="auto")
    assert (result.model.law, result.effects) == (law, ())


def test_effects_that_do_not_apply_to_a_user_law_are_refused(law: str) -> None:
    for effect in ("presliding", "coulomb_drag"):
        error = input_error(jbf.Model, Rig(), law=law, effects=[effect])
        assert effect in str(error)


def test_export_of_a_model_with_a_user_law_is_refused(law: str) -> None:
    error = input_error(export.rust, jbf.Model(Rig(), law=law, parameters=TRUE))
    assert law in str(error)


@pytest.mark.parametrize(
    ("options", "fragment"),
    [
        ({"name": "lugre"}, 'the law "lugre" is in the catalogue already'),
        ({"name": "auto"}, "has an invalid name"),
        ({"name": "my law"}, "has an invalid name"),
        ({"parameters": [Parameter("F_c", "N", starts=(1.0,))]}, "without bounds"),
    ],
)
def test_registration_of_an_invalid_law_is_refused(options: dict, fragment: str) -> None:
    with pytest.raises(InputError, match=fragment):
        jbf.register_law(smooth_coulomb, **({"parameters": PARAMETERS} | options))
    input_error(jbf.forget_law, "smooth_coulomb")


def test_argument_of_a_user_law_that_is_not_a_parameter_is_required_as_a_column() -> None:
    registered = jbf.register_law(smooth_coulomb, parameters=PARAMETERS[:2])
    with pytest.raises(InputError, match="column F_v: is missing, and the law"):
        jbf.Model(Rig(), law=registered.name).predict(runs()[0])
    jbf.forget_law(registered.name)
