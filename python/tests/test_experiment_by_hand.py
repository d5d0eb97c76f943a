"""The run that parts rivals best, of made-up motions; and why none is proposed."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.diagnosis.experiment import Experiment, propose
from jbf.diagnosis.policy import DEFAULT

module = sys.modules["jbf.diagnosis.experiment"]
Names = tuple[str, ...]
A: Names = ("sensor_offset", "sensor_lag")
B: Names = ("sensor_offset", "sensor_drift")
C: Names = ("inertia_leak",)
SAMPLES = 100
NOISE_N = {A: 0.5, B: 0.25, C: 0.1}


def proposed(
    monkeypatch: pytest.MonkeyPatch,
    left: dict[str, dict[tuple[Names, Names], float]],
    rivals: list[list[Names]],
) -> Experiment | str:
    """Of motions in each of which so much is left of one model's friction by another's fit."""

    def model(effects: Names) -> Any:
        return SimpleNamespace(
            at=lambda motion: (effects, motion),
            separation=lambda own, truth, step_s: left[own[1]][own[0], truth[0]],
            noise_n=NOISE_N[effects],
        )

    fitted: list[Names] = []
    monkeypatch.setattr(module, "Rival", model)
    limits = SimpleNamespace(duration_s=30.0)
    monkeypatch.setattr(module, "filled_limits", lambda candidates, given: (limits, 0.02))
    monkeypatch.setattr(
        module,
        "motions",
        lambda candidates, given, step_s: [
            (SimpleNamespace(words=f"a {name}"), [0.0] * SAMPLES, name) for name in left
        ],
    )
    candidates: Any = SimpleNamespace(
        converge=fitted.append,
        fitted=lambda effects: effects,
        policy=DEFAULT,
        campaign=SimpleNamespace(rig=Rig()),
    )
    found = propose(candidates, rivals)
    assert fitted == [effects for group in rivals for effects in group]
    return found


def test_the_motion_whose_least_parted_pair_is_parted_most_is_proposed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A fit that makes up for more than the other is what decides: 60 of the sine, 64 of the
    sweep."""
    left = {
        "rest": {(A, B): 10.0, (B, A): 10.0},
        "sine": {(A, B): 900.0, (B, A): 60.0},
        "sweep": {(A, B): 64.0, (B, A): 70.0},
        "step": {(A, B): 63.0, (B, A): 63.0},
    }
    found = proposed(monkeypatch, left, [[A, B]])
    assert isinstance(found, Experiment)
    assert found.evidence == 64.0
    # Over 100 samples 0.8 of a noise each, of 0.5 N the larger.
    assert found.separation_sigma == pytest.approx(0.8)
    assert found.separation_n == pytest.approx(0.4)
    assert found.words == (
        "record a sweep for 30 s: there sensor_lag and sensor_drift differ by 0.4 N RMS after a "
        "new fit, 0.8 times the noise"
    )


def test_of_two_that_part_as_much_the_first_is_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    same = {(A, B): 64.0, (B, A): 64.0}
    found = proposed(monkeypatch, {"one": same, "other": same}, [[A, B]])
    assert isinstance(found, Experiment)
    assert "record a one " in found.words


@pytest.mark.parametrize(("part", "there"), [(0.999, False), (1.0, True)])
def test_what_parts_too_little_is_not_worth_a_run(
    part: float, there: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    least = part * DEFAULT.least_separation
    found = proposed(monkeypatch, {"sine": {(A, B): least, (B, A): 1e3}}, [[A, B]])
    assert isinstance(found, Experiment) == there
    if not there:
        assert found == (
            "sensor_lag and sensor_drift predict the same friction in every motion within the "
            "limits, once each is fitted: no such run would part them"
        )


def test_without_motions_or_differences_nothing_is_proposed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert isinstance(proposed(monkeypatch, {}, [[A, B]]), str)
    nothing = {"sine": {(A, B): 0.0, (B, A): 0.0}}
    assert isinstance(proposed(monkeypatch, nothing, [[A, B]]), str)


def test_groups_are_parted_each_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs across groups are not asked for; a model that is part of the other has no name."""
    bare: Names = ()
    NOISE_N[bare] = 0.2
    left = {"sine": {(A, B): 400.0, (B, A): 100.0, (C, bare): 400.0, (bare, C): 200.0}}
    found = proposed(monkeypatch, left, [[A, B], [C, bare]])
    assert isinstance(found, Experiment)
    assert found.evidence == 100.0
    assert "sensor_lag and sensor_drift; inertia_leak and nothing more differ" in found.words


def test_what_nobody_can_simulate_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    pages = {
        "x": SimpleNamespace(columns=("pressure_pa", "angle_rad")),
        "y": SimpleNamespace(columns=("humidity",)),
    }
    monkeypatch.setattr(module, "find_effect", pages.__getitem__)
    asked: Any = None
    assert propose(asked, [[("x",), ("y",)]]) == (
        "no run can be proposed: nobody knows what humidity, pressure_pa would be"
    )


def test_a_run_is_written_to_be_played(tmp_path: Any) -> None:
    t = 0.02 * np.arange(20)
    run = Run.from_arrays(t, 0.1 * np.sin(t), name="next")
    Experiment("words", run, 0.4, 0.8, 64.0).write_csv(tmp_path / "next.csv")
    assert (tmp_path / "next.csv").read_text("utf-8") == run.to_csv()
