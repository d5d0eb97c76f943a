"""Invalid arguments of public functions raise an `InputError` of one line."""

from collections.abc import Callable
from typing import Any

import jbf
import numpy as np
import pytest
from input_checks import raises_one_line
from jbf import InputError, Limits, Model, ParameterValue, Rig, Run

LAW = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
T = np.linspace(0.0, 1.0, 50)
RIG = Rig.thesis()
RUN = Run.from_arrays(T, 0.1 * np.sin(T + 0.1), np.ones(50), name="sine")
MODEL = Model(RIG, parameters=LAW)
TEXT: Any = LAW | {"K0": "a"}
ANYTHING: Any = None
CASES: dict[str, tuple[Callable[[], Any], str]] = {
    "law": (lambda: jbf.fit(RIG, [RUN], law="Journal"), 'did you mean "journal"?'),
    "rig a path": (lambda: jbf.fit("rig.toml", [RUN]), 'read it: jbf.read_rig("rig.toml")'),
    "runs and model swapped": (lambda: jbf.compare([RUN], MODEL), "the model is a Run"),
    "speed of zero": (lambda: MODEL.steady_friction([0.0]), "must be finite and not zero"),
    "text": (lambda: jbf.trajectory(RIG, TEXT, T, T), 'key parameters.K0: "a" is not a number'),
    "sine without omega": (lambda: jbf.trajectory(RIG, LAW, T, sine=(1.0,)), "omega in rad/s"),
    "trajectories": (lambda: jbf.trajectories(RIG, LAW, [RUN]), "run 0 is a Run; give a pair"),
    "method of batch": (lambda: jbf.batch(RIG, T, 0.1, method="rk5", **LAW), '"rk4"?'),
    "bootstrap of a model": (lambda: jbf.bootstrap(MODEL, [RUN]), "the fit is a Model"),
    "trajectories to fit": (lambda: jbf.fit_trajectories(RIG, [RUN], [T]), "run 0 is a Run"),
    "list of campaigns": (lambda: jbf.diagnose_many([RIG]), "campaigns is a list; give a dict"),
    "option of diagnose_many": (lambda: jbf.diagnose_many({}, effects=[]), "is not known"),
    "model of a control run": (lambda: jbf.control.run("m.toml"), 'jbf.Model.load("m.toml")'),
    "scheme of a control run": (lambda: jbf.control.run(scheme=ANYTHING), "the scheme is None"),
    "effect": (lambda: jbf.fit(RIG, [RUN], ["sensor_ofset"]), 'did you mean "sensor_offset"?'),
    "no run": (lambda: jbf.compare(MODEL, []), "no run"),
    "no run in a plan": (lambda: jbf.planned_power(MODEL, [], noise_rms=0.1), "no run was given"),
    "value nan": (lambda: Model(Rig(), "coulomb", parameters={"F_c": np.nan}), "F_c"),
    "value an array": (lambda: ParameterValue(ANYTHING or np.ones(2)), "a ndarray is not"),
    "unknown parameter": (lambda: Model(RIG, parameters={"fm": 0.2}), "is not known"),
    "load limit nan": (lambda: Limits(load_n=(5.0, float("nan"))), "load_n = nan"),
    "no angle": (lambda: Model(RIG, effects=["position_ripple"]).predict(RUN), "angle_rad"),
}


@pytest.mark.parametrize(("call", "fragment"), CASES.values(), ids=CASES)
def test_invalid_function_argument_raises_one_line_input_error(call: Any, fragment: str) -> None:
    raises_one_line(call, fragment)


def test_diagnose_many_returns_a_separate_error_for_each_invalid_campaign() -> None:
    campaigns: Any = {"number": 3, "three": (1, 2, 3), "run": (RIG, RUN)}
    results = jbf.diagnose_many(campaigns)
    assert list(results) == list(campaigns)
    assert {type(error) for error in results.values()} == {InputError}
    assert "write a list of one" in str(results["run"])


def test_bare_numbers_given_as_model_parameters_become_parameter_values() -> None:
    model = Model(RIG, parameters={"f_m": 0.3, "K0": jbf.ParameterValue(1e6, 2e4)})
    assert model.parameters["f_m"] == jbf.ParameterValue(0.3)
    assert model.parameters["K0"].stderr == 2e4
    assert {type(p) for p in model.parameters.values()} == {jbf.ParameterValue}
