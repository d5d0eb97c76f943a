"""What hides in runs, which run shows most of it, and which names stand: by made-up answers."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import Rig
from jbf.diagnosis.constancy import Disagreement
from jbf.diagnosis.ledger import Remainder, Step, Trial
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.standing import (
    CONFOUNDER,
    REPLACED,
    as_it_ended,
    best_predicting,
    confounders,
)
from jbf.diagnosis.unseen import propose_to_see, unseen
from jbf.diagnosis.verdict import name_stands

hiding = sys.modules["jbf.diagnosis.unseen"]
standing = sys.modules["jbf.diagnosis.standing"]


def powers(**hidden: bool) -> Any:
    return [SimpleNamespace(effect=name, hidden=is_hidden) for name, is_hidden in hidden.items()]


# ---- what hides --------------------------------------------------------------------------------


@pytest.mark.parametrize(("changes", "seen"), [(True, ("backlash",)), (False, ())])
def test_what_is_hidden_and_would_change_something_is_told(
    changes: bool, seen: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of an effect that needs what another transmits only where it changes a prediction."""
    pages = {
        "sensor_offset": SimpleNamespace(columns=(), needs=()),
        "backlash": SimpleNamespace(columns=("angle_rad",), needs=("transmitted",)),
        "strange": SimpleNamespace(columns=("pressure_pa",), needs=()),
        "found": SimpleNamespace(columns=(), needs=()),
    }
    monkeypatch.setattr(hiding, "find_effect", pages.__getitem__)
    monkeypatch.setattr(hiding, "_changes", lambda candidates, present, name: changes)
    candidates: Any = SimpleNamespace(names=list(pages))
    told = powers(sensor_offset=True, backlash=True, strange=True, found=False)
    assert unseen(candidates, (), told) == ("sensor_offset", *seen)
    assert unseen(candidates, (), []) == ()
    # In whatever order they come.
    candidates.names = list(pages)[::-1]
    assert unseen(candidates, (), told) == (*seen, "sensor_offset")


@pytest.mark.parametrize(("more", "changes"), [(0.0, False), (1e-9, True)])
def test_an_effect_changes_where_one_run_differs(
    more: float, changes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = [np.zeros(5), np.ones(5)]
    there = [np.zeros(5), np.ones(5) + more * (np.arange(5) == 3)]
    richer = SimpleNamespace(predict=lambda values: there)
    monkeypatch.setattr(hiding, "_with_usual", lambda candidates, present, name: (richer, None))
    problem = SimpleNamespace(predict=lambda values: now)
    candidates: Any = SimpleNamespace(
        fitted=lambda present: SimpleNamespace(problem=problem),
        converge=lambda present: SimpleNamespace(values=None),
    )
    assert hiding._changes(candidates, (), "one") == changes


def proposed(
    monkeypatch: pytest.MonkeyPatch, shown: dict[str, dict[str, float]]
) -> tuple[Any, list[str]]:
    """The run that is proposed of some motions, in each of which effects are worth so much."""
    hidden = list(next(iter(shown.values())))

    def problem(name: str) -> Any:
        chain = SimpleNamespace(predict=lambda values, motion: [(name, motion[0])])
        return SimpleNamespace(chain=chain, open=range(4))

    base = SimpleNamespace(
        solution=SimpleNamespace(free=3),
        noise_n=0.5,
        at=lambda motion: ("own", "slopes"),
        separation=lambda own, truth, step_s: shown[truth[0][1]][truth[0][0]],
    )
    limits = SimpleNamespace(duration_s=30.0)
    monkeypatch.setattr(hiding, "filled_limits", lambda c, given: (limits, 0.02))
    monkeypatch.setattr(hiding, "Rival", lambda fitted: base)
    monkeypatch.setattr(hiding, "_with_usual", lambda c, present, name: (problem(name), None))
    monkeypatch.setattr(hiding, "price_of", lambda c, parameters: 30.0)
    run = [0.0] * 100
    monkeypatch.setattr(
        hiding,
        "motions",
        lambda c, given, step: [(SimpleNamespace(words=f"a {m}"), run, m) for m in shown],
    )
    candidates: Any = SimpleNamespace(
        converge=lambda present: None,
        fitted=lambda present: None,
        policy=DEFAULT,
        campaign=SimpleNamespace(rig=Rig()),
    )
    return propose_to_see(candidates, (), hidden), hidden


def test_the_run_that_shows_most_of_what_hides_is_proposed(monkeypatch: pytest.MonkeyPatch) -> None:
    """One that shows both beats one that shows one of them far better."""
    found, _ = proposed(
        monkeypatch,
        {
            "sine": {"one": 1e6, "two": 1.0},
            "stop": {"one": 200.0, "two": 300.0},
            "ramp": {"one": 20.0, "two": 20.0},
        },
    )
    assert not isinstance(found, str)
    assert found.words == (
        "these runs could not show one, two at a usual strength: record a stop for 30 s, which "
        "would show them"
    )
    # Their mean in logarithms, over a hundred samples of a noise of 0.5 N.
    assert found.evidence == pytest.approx(np.sqrt(200.0 * 300.0))
    assert found.separation_sigma == pytest.approx(np.sqrt(found.evidence / 100.0))
    assert found.separation_n == pytest.approx(0.5 * found.separation_sigma)
    some, _ = proposed(monkeypatch, {"sine": {"one": 1e6, "two": 1.0}})
    assert some.words.endswith(" record a sine for 30 s, which would show one")
    assert some.evidence == pytest.approx(1e6)
    # Of two that are as likely to show it the one in which it is worth more.
    more, _ = proposed(monkeypatch, {"sine": {"one": 1e6}, "stop": {"one": 1e7}})
    assert "a stop" in more.words
    first, _ = proposed(monkeypatch, {"sine": {"one": 1e6}, "stop": {"one": 1e6}})
    assert "a sine" in first.words


def test_a_hundredth_in_the_chances_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 55 each 1.42 effects are found, of a million and of twenty 1.35; that these are worth far
    more is no matter."""
    shown = {"sine": {"one": 1e6, "two": 20.0}, "stop": {"one": 55.0, "two": 55.0}}
    found, _ = proposed(monkeypatch, shown)
    assert not isinstance(found, str)
    assert "record a stop " in found.words


@pytest.mark.parametrize(("most", "told"), [(0.99, False), (1.0, False), (1.01, True)])
def test_what_no_motion_shows_is_said(
    most: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    least = 2.0 * DEFAULT.least_separation
    found, _ = proposed(monkeypatch, {"sine": {"one": most * least}})
    assert isinstance(found, str) != told
    if not told:
        assert str(found).startswith("these runs could not show one at a usual strength")
    nothing, _ = proposed(monkeypatch, {"sine": {"one": 0.0, "two": 0.0}})
    assert str(nothing).startswith("these runs could not show one, two at a usual strength")


# ---- which names stand -------------------------------------------------------------------------


def doubted(
    monkeypatch: pytest.MonkeyPatch,
    *,
    gain: float,
    left: float,
    remains: tuple[float, ...] = (),
    own: Disagreement | None = None,
    stands: bool = True,
) -> tuple[tuple[str, ...], list[Any]]:
    """Whether an effect is a confounder that gains so much, by leaving so much of the RMS."""
    asked: list[Any] = []

    def name_stands(gained: float, beyond: float | None, policy: Any) -> bool:
        asked.append((gained, beyond))
        return stands

    monkeypatch.setattr(standing, "effective_share", lambda solution: 0.5)
    monkeypatch.setattr(standing, "likelihood_gain", lambda whole, rest: gain)
    monkeypatch.setattr(standing, "price_of", lambda c, parameters: 10.0 * parameters)
    monkeypatch.setattr(standing, "disagreement", lambda *told: own or Disagreement(0.0, 3, {}))
    monkeypatch.setattr(standing, "name_stands", name_stands)
    solutions = {
        ("one",): SimpleNamespace(rms_n=left, free=4),
        (): SimpleNamespace(rms_n=1.0, free=3),
    }
    candidates: Any = SimpleNamespace(
        converge=solutions.__getitem__,
        fitted=lambda present: SimpleNamespace(problem=None),
        policy=DEFAULT,
    )
    left_over = [Remainder("time", "", share) for share in remains]
    return confounders(candidates, ("one",), left_over), asked


@pytest.mark.parametrize(
    ("gain", "left", "remains", "doubt"),
    [
        # Weak, by half of its gain less a price of ten, and less than the largest that remains.
        (2.0 * (DEFAULT.weak + 9.9), 0.9, (0.05, 0.2), True),
        (2.0 * (DEFAULT.weak + 10.1), 0.9, (0.05, 0.2), False),
        # It explains 1 - 0.81.
        (2.0 * (DEFAULT.weak + 9.9), 0.9, (0.18, 0.05), False),
        (2.0 * (DEFAULT.weak + 9.9), 0.9, (), False),
        (1.0, 0.999, (0.01,), True),
        # Of just as much as weak evidence has, and of just as much as it explains.
        (2.0 * (DEFAULT.weak + 10.0), 0.9, (0.05, 0.2), True),
        (1.0, 0.9, (1.0 - 0.9**2,), False),
    ],
)
def test_a_weak_effect_that_explains_less_than_remains_is_doubted(
    gain: float,
    left: float,
    remains: tuple[float, ...],
    doubt: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, _ = doubted(monkeypatch, gain=gain, left=left, remains=remains)
    assert found == (("one",) if doubt else ())


def test_an_effect_on_which_runs_disagree_is_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    beyond = Disagreement(1e4, 3, {})
    found, asked = doubted(monkeypatch, gain=1e4, left=0.5, own=beyond, stands=False)
    assert found == ("one",)
    # Half of the gain is held against what they would gain beyond chance.
    assert asked == [(5e3, 1e4 - 3)]
    assert doubted(monkeypatch, gain=1e4, left=0.5, own=beyond)[0] == ()
    _, within = doubted(monkeypatch, gain=1e4, left=0.5, own=Disagreement(5.0, 3, {}))
    assert within == [(5e3, None)]


def test_a_name_stands_by_more_than_what_runs_disagree_by() -> None:
    assert name_stands(0.0, None, DEFAULT)
    least = DEFAULT.clear * 7.0
    assert not name_stands(least, 7.0, DEFAULT)
    assert name_stands(least + 1e-9, 7.0, DEFAULT)


def test_confounders_stay_where_runs_left_out_are_predicted_better() -> None:
    def of(**left: float) -> Any:
        return SimpleNamespace(left_out_rms=lambda names: left["".join(names)])

    assert best_predicting(of(ab=1.0, a=1.1), ("a", "b"), ("a",)) == ("a", "b")
    assert best_predicting(of(ab=1.1, a=1.0), ("a", "b"), ("a",)) == ("a",)
    assert best_predicting(of(ab=1.0, a=1.0), ("a", "b"), ("a",)) == ("a",)
    assert best_predicting(of(), ("a", "b"), ("a", "b")) == ("a", "b")


def test_the_ledger_says_what_became_of_each() -> None:
    def trial(name: str, outcome: Any = "added") -> Trial:
        return Trial(name, 1.0, 2.0, outcome, "as it was")

    steps = [
        Step((), 1.0, 1.0, 0.5, (trial("a"), trial("b"), trial("c", "ties"))),
        Step(("a",), 1.0, 1.0, 0.5, (trial("d"),)),
    ]
    ended = as_it_ended(steps, ("a", "b"), ("b",))
    told = [(t.effect, t.outcome, t.reason) for s in ended for t in s.trials]
    assert told == [
        ("a", "added", "as it was"),
        ("b", "confounder", CONFOUNDER),
        ("c", "ties", "as it was"),
        ("d", "replaced", REPLACED),
    ]
    assert [s.effects for s in ended] == [(), ("a",)]
