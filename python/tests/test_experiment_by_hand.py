"""The run that parts rivals best, of made-up motions; and why none is proposed."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import Rig, Run
from jbf.diagnosis.experiment import Experiment, _names, propose

proposing = sys.modules["jbf.diagnosis.experiment"]


def test_rivals_are_named_by_what_they_do_not_share() -> None:
    group = [("a", "b"), ("a", "c", "d"), ("a",)]
    assert _names([group]) == "b and c + d and nothing more"
    assert _names([[("a",), ("b",)], [("c", "a"), ("c", "d")]]) == "a and b; a and d"


def rivals(monkeypatch: pytest.MonkeyPatch, apart: dict[str, dict[tuple[str, str], float]]) -> Any:
    """Candidates whose models are so far apart in each of some motions, in squares of noise."""
    run = [0.0] * 100
    excitations = [SimpleNamespace(words=f"a {name}") for name in apart]
    monkeypatch.setattr(
        proposing, "filled_limits", lambda c, limits: (SimpleNamespace(duration_s=30.0), 0.02)
    )
    monkeypatch.setattr(
        proposing, "motions", lambda c, limits, step: [(e, run, e.words[2:]) for e in excitations]
    )

    def rival(fitted: str) -> Any:
        def separation(own: Any, truth: Any, step_s: float) -> float:
            motion, a = own
            return apart[motion][a, truth[1]]

        noise = {"sensor_offset": 0.5}.get(fitted, 0.2)
        return SimpleNamespace(
            at=lambda motion: (motion, fitted), separation=separation, noise_n=noise
        )

    monkeypatch.setattr(proposing, "Rival", rival)
    return SimpleNamespace(
        converge=lambda effects: None,
        fitted=lambda effects: effects[0],
        policy=SimpleNamespace(least_separation=25.0),
        campaign=SimpleNamespace(rig=Rig()),
    )


A, B = "sensor_offset", "coulomb_drag"


def both(there: float, back: float) -> dict[tuple[str, str], float]:
    return {(A, B): there, (B, A): back}


def test_the_run_that_parts_the_least_apart_is_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of the two may be the truth: what is told of the worse case counts."""
    candidates = rivals(
        monkeypatch,
        {"sine": both(900.0, 30.0), "stop": both(100.0, 64.0), "ramp": both(63.0, 64.0)},
    )
    found = propose(candidates, [[(A,), (B,)]])
    assert not isinstance(found, str)
    assert found.evidence == 64.0
    # Of a hundred samples 0.8 of the noise, which is 0.5 N of the two.
    assert found.separation_sigma == pytest.approx(0.8)
    assert found.separation_n == pytest.approx(0.4)
    assert found.words == (
        f"record a stop for 30 s: there {A} and {B} differ by 0.4 N RMS after a new fit, "
        "0.8 times the noise"
    )
    assert len(found.run) == 100


@pytest.mark.parametrize(("most", "told"), [(24.9, False), (25.0, True)])
def test_what_parts_no_two_is_not_proposed(
    most: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = propose(rivals(monkeypatch, {"sine": both(most, 99.0)}), [[(A,), (B,)]])
    assert isinstance(found, str) != told
    if not told:
        assert str(found).startswith(f"{A} and {B} predict the same friction in every motion")
    # Of two that part them as far the first.
    two = propose(
        rivals(monkeypatch, {"sine": both(64.0, 64.0), "stop": both(64.0, 99.0)}), [[(A,), (B,)]]
    )
    assert not isinstance(two, str)
    assert two.words.startswith("record a sine")
    nothing = propose(rivals(monkeypatch, {"sine": both(0.0, 0.0)}), [[(A,), (B,)]])
    assert "no such run would part them" in str(nothing)


def test_columns_that_nobody_knows_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    page = SimpleNamespace(columns=("pressure_pa", "time_s", "angle_rad"))
    monkeypatch.setattr(proposing, "find_effect", lambda name: page)
    found = propose(rivals(monkeypatch, {"sine": both(99.0, 99.0)}), [[(A,), (B,)]])
    assert found == "no run can be proposed: nobody knows what pressure_pa would be"


def test_groups_are_parted_each_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs across groups are not asked for; of all of them the least apart decides."""
    c, d = "inertia_leak", "sensor_lag"
    apart = {"sine": both(400.0, 300.0) | {(c, d): 100.0, (d, c): 400.0}}
    fitted: list[Any] = []
    candidates = rivals(monkeypatch, apart)
    candidates.converge = fitted.append
    found = propose(candidates, [[(A,), (B,)], [(c,), (d,)]])
    assert not isinstance(found, str)
    assert found.evidence == 100.0
    assert f"{A} and {B}; {c} and {d} differ" in found.words
    assert fitted == [(A,), (B,), (c,), (d,)]
    assert isinstance(propose(rivals(monkeypatch, {}), [[(A,), (B,)]]), str)


def test_a_run_is_written_to_be_played(tmp_path: Path) -> None:
    t = 0.02 * np.arange(20)
    run = Run.from_arrays(t, 0.1 * np.sin(t), name="next")
    Experiment("words", run, 0.4, 0.8, 64.0).write_csv(tmp_path / "next.csv")
    assert (tmp_path / "next.csv").read_text("utf-8") == run.to_csv()
