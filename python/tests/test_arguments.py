"""Whatever is passed wrongly to a public function ends as one clear line of `InputError`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import jbf
import numpy as np
import pytest
from jbf import InputError, Model, Rig, Run

LAW = {"f_m": 0.26, "U_tr_m_s": 0.06, "K0": 7.5e5, "gamma": 33.0}
T = np.linspace(0.0, 1.0, 50)
RIG = Rig.thesis()
RUN = Run.from_arrays(T, 0.1 * np.sin(T + 0.1), np.ones(50), name="sine")
MODEL = Model(RIG, parameters=LAW)

ANYTHING: Any = None
CASES: dict[str, tuple[Callable[[], Any], str]] = {
    "effects a word": (
        lambda: jbf.fit(RIG, [RUN], effects="presliding"),
        'effects is text where a list of names is meant; write effects=["presliding"]',
    ),
    "effects none": (lambda: jbf.fit(RIG, [RUN], effects=ANYTHING), "effects is None; write a"),
    "effects numbers": (lambda: Model(RIG, effects=[1]), "effects holds an int"),
    "clock": (
        lambda: jbf.fit(RIG, [RUN], clock="Thesis"),
        'there is no clock "Thesis"; did you mean "thesis"?',
    ),
    "model's clock": (lambda: Model(RIG, clock="Thesis"), 'did you mean "thesis"?'),
    "law": (lambda: jbf.fit(RIG, [RUN], law="Journal"), 'did you mean "journal"?'),
    "law none": (lambda: Model(RIG, law=ANYTHING), "the law is None; known: journal"),
    "rig a path": (lambda: jbf.fit("rig.toml", [RUN]), 'read it: jbf.read_rig("rig.toml")'),
    "rig a Path": (lambda: jbf.diagnose(Path("r.toml"), [RUN]), 'jbf.read_rig("r.toml")'),
    "rig none": (lambda: Model(ANYTHING), "the rig is None; give a jbf.Rig"),
    "swapped": (lambda: jbf.diagnose([RUN], RIG), "the rig is a list; give a jbf.Rig, first"),
    "swapped fit": (lambda: jbf.fit([RUN], RIG), "the rig is a list; give a jbf.Rig, first"),
    "swapped compare": (lambda: jbf.compare([RUN], MODEL), "the model is a list"),
    "model a path": (lambda: jbf.compare("m.toml", [RUN]), 'jbf.Model.load("m.toml")'),
    "compare a run": (lambda: jbf.compare(MODEL, RUN), "runs is a single run; write a list of one"),
    "compare none": (lambda: jbf.compare(MODEL, ANYTHING), "runs is None"),
    "compare a rig": (lambda: jbf.compare(MODEL, RIG), "give the rig first"),
    "compare paths": (
        lambda: jbf.compare(MODEL, ["a.csv"]),
        'runs holds "a.csv" at place 0; read it: jbf.read_run("a.csv")',
    ),
    "predict a path": (lambda: MODEL.predict("a.csv"), 'jbf.read_run("a.csv")'),
    "predict a list": (lambda: MODEL.predict([RUN]), "the run is a list; give one of them"),
    "predict one of many": (lambda: MODEL.predict_many(RUN), "runs is a single run"),
    "parameters a list": (lambda: Model(RIG, parameters=[1.0]), "parameters is a list"),
    "parameter a text": (
        lambda: Model(RIG, parameters={"f_m": "0.2"}),
        'key parameters.f_m.value: "0.2" is not a number',
    ),
    "at rest": (lambda: MODEL.steady_friction([0.0]), "must be finite and not zero"),
    "speeds a text": (lambda: MODEL.steady_friction("a"), "no array of numbers"),
    "trajectory's rig": (lambda: jbf.trajectory(ANYTHING, LAW, T, T), "the rig is None"),
    "trajectory's clock": (lambda: jbf.trajectory(RIG, LAW, T, T, clock="Thesis"), '"thesis"?'),
    "trajectory's value": (
        lambda: jbf.trajectory(RIG, LAW | {"K0": "a"}, T, T),
        'key parameters.K0: "a" is not a number',
    ),
    "trajectory's shape": (lambda: jbf.trajectory(RIG, LAW, T[None], T[None]), "has shape (1, 50)"),
    "trajectory's times": (lambda: jbf.trajectory(RIG, LAW, T, T[1:]), "as many as the times"),
    "sine": (lambda: jbf.trajectory(RIG, LAW, T, sine=(1.0,)), "omega in rad/s"),
    "trajectories": (lambda: jbf.trajectories(RIG, LAW, [RUN]), "run 0 is a Run; give a pair"),
    "batch's rig": (lambda: jbf.batch("r.toml", T, 0.1, **LAW), 'jbf.read_rig("r.toml")'),
    "batch's clock": (lambda: jbf.batch(RIG, T, 0.1, clock="Thesis", **LAW), '"thesis"?'),
    "batch's method": (lambda: jbf.batch(RIG, T, 0.1, method="rk5", **LAW), '"rk4"?'),
    "batch's speeds": (lambda: jbf.batch(RIG, RUN, 0.1, **LAW), "no array of numbers"),
    "fit a run": (lambda: jbf.fit(RIG, RUN), "runs is a single run; write a list of one: [run]"),
    "diagnose paths": (lambda: jbf.diagnose(RIG, ["a.csv"]), 'jbf.read_run("a.csv")'),
    "diagnose's clock": (lambda: jbf.diagnose(RIG, [RUN], clock="Thesis"), '"thesis"?'),
    "limits": (lambda: jbf.diagnose(RIG, [RUN], limits=3), "limits is an int"),
    "progress": (lambda: jbf.diagnose(RIG, [RUN], progress=3), "progress is an int"),
    "start a list": (lambda: jbf.fit(RIG, [RUN], start=[1.0]), "parameters is a list"),
    "start a text": (lambda: jbf.fit(RIG, [RUN], start={"f_m": "a"}), '"a" is not a number'),
    "bootstrap a model": (lambda: jbf.bootstrap(MODEL, [RUN]), "the fit is a Model"),
    "bootstrap's repeats": (lambda: jbf.bootstrap(MODEL, [RUN], repeats="a"), 'repeats is "a"'),
    "trajectories to fit": (lambda: jbf.fit_trajectories(RIG, [RUN], [T]), "run 0 is a Run"),
    "frictions to fit": (
        lambda: jbf.fit_trajectories(RIG, [(T, T)], ["a"]),
        "the friction of run 0 is no array of numbers",
    ),
    "many's campaigns": (lambda: jbf.diagnose_many([RIG]), "campaigns is a list; give a dict"),
    "many's option": (lambda: jbf.diagnose_many({}, effects=[]), "there is no option"),
    "many's clock": (lambda: jbf.diagnose_many({}, clock="Thesis"), '"thesis"?'),
    "no path": (lambda: jbf.read_rig(ANYTHING), "None is not a path"),
    "no path of a run": (lambda: jbf.read_run(ANYTHING), "None is not a path"),
    "no paths": (lambda: jbf.read_runs(ANYTHING), "None is not a path"),
    "loop's model": (lambda: jbf.control.run("m.toml"), 'jbf.Model.load("m.toml")'),
    "loop's task": (lambda: jbf.control.run(task="velocity sine"), "name one of control.TASKS"),
    "loop's scheme": (lambda: jbf.control.run(scheme=ANYTHING), "the scheme is None"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_wrong_argument_is_one_clear_line(name: str) -> None:
    call, said = CASES[name]
    with pytest.raises(InputError) as caught:
        call()
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_campaign_that_is_none_ends_as_its_own_error() -> None:
    given: Any = {"number": 3, "three": (1, 2, 3), "run": (RIG, RUN)}
    found = jbf.diagnose_many(given)
    assert {name: type(error) for name, error in found.items()} == dict.fromkeys(given, InputError)
    assert "write a list of one" in str(found["run"])


def test_a_model_takes_bare_numbers_and_holds_values_with_errors() -> None:
    model = Model(RIG, parameters={"f_m": 0.3, "K0": jbf.ParameterValue(1e6, 2e4)})
    assert model.parameters["f_m"] == jbf.ParameterValue(0.3)
    assert model.parameters["K0"].stderr == 2e4
    assert {type(p) for p in model.parameters.values()} == {jbf.ParameterValue}
