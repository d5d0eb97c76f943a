"""What a plan is asked for: how many runs of which motions, what they cost, and what is none."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from by_hand import LAW
from jbf import InputError, Limits, Model, Rig, Run, plan
from jbf.diagnosis.plan import LEAST_RUNS, MOST_RUNS, Plan
from jbf.diagnosis.policy import DEFAULT
from jbf.records.drive import Drive

module = sys.modules["jbf.diagnosis.plan"]
MODEL = Model(Rig(), "coulomb", parameters=LAW)
OWN = 3
"""Parameters of the law."""


class Asked:
    """In place of all that a plan is made of; the motions are as many as told."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, motions: int = 30) -> None:
        self.limits: list[Any] = []
        self.linear: set[bool] = set()
        self.few: list[str] = []
        self.told: list[str] = []
        self.chosen: list[Any] = []
        run = Run.from_arrays(0.02 * np.arange(20), np.zeros(20), name="next")

        def excitations(limits: Limits, step_s: float, unit: str) -> list[Any]:
            self.limits.append((limits, step_s, unit))
            return [SimpleNamespace(words=f"motion {k}") for k in range(motions)]

        def played(rig: Rig, excitation: Any, step_s: float, *, linear: bool) -> Run:
            assert step_s == self.limits[0][1]
            self.linear.add(linear)
            return run

        def recorded(model: Model, named: list[Run], noise_n: float, policy: Any) -> Any:
            assert (noise_n, policy) == (0.5, DEFAULT)
            self.few = [r.name for r in named]
            fitted = SimpleNamespace(problem=SimpleNamespace(open=range(OWN)))
            return SimpleNamespace(fitted=lambda effects: fitted)

        def chosen(told: Any, own: int, prices: Any, count: int) -> list[int]:
            self.chosen.append((len(told), own, prices.tolist(), count))
            return [(k + 1) % motions for k in range(count)]

        # Of no parameter beyond the law's, of one and of three.
        effects = [SimpleNamespace(problem=SimpleNamespace(open=range(OWN + n))) for n in (0, 1, 3)]
        for name, part in {
            "excitations": excitations,
            "played": played,
            "as_recorded": recorded,
            "_effects": lambda candidates, model: effects,
            "_told": lambda candidates, model, effects, run, noise_n: "told",
            "price_of": lambda candidates, parameters: 10.0 * parameters,
            "_chosen": chosen,
            "planned_power": lambda model, runs, *, noise_n, policy: ("power", len(runs), noise_n),
        }.items():
            monkeypatch.setattr(module, name, part)

    def plan(self, minutes: float = 2.0, model: Model = MODEL, **more: Any) -> Plan:
        limits = Limits(0.2, 0.3, more.pop("duration_s", 30.0))
        return plan(model, **{"limits": limits, "minutes": minutes, "noise_n": 0.5, **more})


@pytest.mark.parametrize(
    ("minutes", "duration_s", "count"),
    [
        (1.5, 30.0, 3),
        (1.99, 30.0, 3),
        (2.0, 30.0, 4),
        # What rounds down to just less than a whole number is that number.
        (7.0 * 35.0 / 60.0, 35.0, 7),
        (100.0, 30.0, MOST_RUNS),
    ],
)
def test_as_many_runs_as_there_is_time_for(
    minutes: float, duration_s: float, count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Asked(monkeypatch)
    found = asked.plan(minutes, duration_s=duration_s)
    assert asked.chosen == [(30, OWN, [10.0, 10.0, 30.0], count)]
    assert [r.name for r in found.runs] == [f"{k:02d}" for k in range(1, count + 1)]
    assert found.words == tuple(f"motion {(k + 1) % 30}" for k in range(count))
    power: Any = found.planned
    assert power == ("power", count, 0.5)


@pytest.mark.parametrize(
    ("minutes", "said"),
    [
        (1.49, "1.49 hold 2 runs of 30 s; give time for 3 runs or more, or make them shorter"),
        (100.5, "100.5 hold more than 200 runs of 30 s; give less time, or make the runs longer"),
        (1e300, "hold more than 200 runs"),
        (0.0, "minutes: 0 is not above zero; give more"),
        (np.inf, "minutes: inf is not above zero"),
    ],
)
def test_too_few_and_too_many_runs_are_no_plan(
    minutes: float, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert (LEAST_RUNS, MOST_RUNS) == (3, 200)
    with pytest.raises(InputError) as refused:
        Asked(monkeypatch).plan(minutes)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("duration_s", "given", "step_s"),
    [
        (30.0, {}, 0.02),
        (240.0, {}, 0.04),
        (240.0, {"step_s": 0.1}, 0.1),
        (30.0, {"step_s": 1e-3}, 0.005),
    ],
)
def test_no_run_has_more_than_6000_samples(
    duration_s: float, given: dict[str, Any], step_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Asked(monkeypatch)
    asked.plan(30.0, duration_s=duration_s, **given)
    assert asked.limits == [(Limits(0.2, 0.3, duration_s), pytest.approx(step_s), "m/s")]


def test_an_acceleration_that_is_not_given_is_that_of_a_usual_sine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = Asked(monkeypatch)
    asked.plan(limits=Limits(0.2, duration_s=30.0))
    assert asked.limits[0][0] == Limits(0.2, 0.4, 30.0)


@pytest.mark.parametrize(("motions", "few"), [(3, 3), (7, 7), (13, 13), (14, 7), (30, 8), (36, 8)])
def test_a_few_of_the_motions_tell_what_could_be_there(
    motions: int, few: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every seventh part of them, each by a name of its own."""
    asked = Asked(monkeypatch, motions)
    asked.plan()
    assert asked.few == [f"{i}" for i in range(few)]
    assert asked.chosen[0][0] == motions


@pytest.mark.parametrize(
    ("rig", "law", "linear"),
    [
        (Rig(), "coulomb", True),
        (Rig(drive=Drive("linear", "force")), "coulomb", True),
        (Rig(drive=Drive("rotary", "torque")), "coulomb", False),
        (Rig.thesis(), "journal", False),
    ],
)
def test_slides_have_positions_and_shafts_angles(
    rig: Rig, law: str, linear: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = Asked(monkeypatch)
    asked.plan(model=Model(rig, law))
    assert asked.linear == {linear}


def test_what_is_asked_for_goes_by_name() -> None:
    by_place: Any = plan
    with pytest.raises(TypeError, match="positional"):
        by_place(MODEL, Limits(0.2), 2.0, 0.5)
