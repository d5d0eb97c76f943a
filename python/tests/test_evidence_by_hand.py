"""Evidence of models and what an exchange costs, of made-up gains: each way that it may end."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf.diagnosis.evidence import evidence, evidence_alone, price_of, swap_cost
from jbf.diagnosis.policy import DEFAULT

module = sys.modules["jbf.diagnosis.evidence"]
PRICE = 20.0
"""Of each parameter that a model has."""


def model(gain: float, free: int = 4, rms_n: float = 1.0, effects: tuple[str, ...] = ("a",)) -> Any:
    """A solution that gains so much, in twice the log likelihood."""
    return SimpleNamespace(gain=gain, free=free, rms_n=rms_n, effects=effects, samples="all")


def told(monkeypatch: pytest.MonkeyPatch, **parts: Any) -> None:
    for name, part in parts.items():
        monkeypatch.setattr(module, name, part)


@pytest.fixture(autouse=True)
def _made_up(monkeypatch: pytest.MonkeyPatch) -> None:
    told(
        monkeypatch,
        likelihood_gain=lambda richer, simpler: richer.gain - simpler.gain,
        effective_share=lambda solution: 0.5,
        share_of_gain=lambda richer, simpler: 0.25,
        gain_of_most=lambda richer, simpler: np.inf,
        _within_steps=lambda campaign, richer, simpler: False,
        next_step_gain=lambda near: 3.0,
        many_peaks=lambda effects: "peaks" in effects,
    )


def candidates(**more: Any) -> Any:
    return SimpleNamespace(
        level=SimpleNamespace(price=lambda parameters, samples: PRICE * parameters),
        campaign=SimpleNamespace(samples=SimpleNamespace(count=1000)),
        policy=DEFAULT,
        idle=lambda solution: (),
        **more,
    )


# ---- evidence ----------------------------------------------------------------------------------


def test_evidence_is_what_counts_of_the_gain_less_the_price() -> None:
    rich, base = model(400.0, 6), model(0.0, 4)
    assert price_of(candidates(), 2) == 40.0
    assert evidence(candidates(), rich, base) == pytest.approx(0.25 * 400.0 - 40.0)
    assert evidence(candidates(), rich, base, anywhere=True) == pytest.approx(0.5 * 400.0 - 40.0)
    # What is lost is lost in full.
    assert evidence(candidates(), model(-100.0, 6), base) == -140.0
    assert evidence(candidates(), model(0.0, 6), base) == -40.0


@pytest.mark.parametrize(
    ("of_most", "counts"), [(41.0, 100.0), (40.0, 40.0), (13.0, 13.0), (-5.0, 0.0)]
)
def test_a_gain_of_a_few_samples_is_what_the_others_gain(
    of_most: float, counts: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where those pay the price the gain stands, however much of it a few brought."""
    told(monkeypatch, gain_of_most=lambda richer, simpler: of_most)
    rich, base = model(400.0, 6), model(0.0, 4)
    assert evidence(candidates(), rich, base) == pytest.approx(counts - 40.0)
    # What does not pay it anyway is not asked.
    assert evidence(candidates(), model(100.0, 6), base) == pytest.approx(25.0 - 40.0)


def test_a_gain_within_a_converters_steps_or_beside_an_idle_effect_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rich, base = model(400.0, 5, effects=("a", "b")), model(0.0, 4)
    idle = candidates()
    idle.idle = lambda solution: ("b",)
    assert evidence(idle, rich, base) == -PRICE
    assert evidence(idle, model(-8.0, 5), base) == -8.0 - PRICE
    # One that was idle before is no matter.
    idle.idle = lambda solution: ("a",)
    assert evidence(idle, rich, base) == 80.0
    told(monkeypatch, _within_steps=lambda campaign, richer, simpler: True)
    assert evidence(candidates(), rich, base) == -PRICE
    assert evidence(candidates(), model(-8.0, 5), base) == -8.0 - PRICE


def test_what_sets_samples_aside_is_judged_by_those_it_leaves(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The simpler model, fitted to the same samples, may gain as much."""
    rich, base = model(400.0, 5), model(0.0, 4)
    rich.samples = "few"
    asked: list[Any] = []

    def search(problem: Any, samples: Any, values: Any, noise: Any, evaluations: int) -> Any:
        asked.append(samples)
        return SimpleNamespace(values="there")

    base.values = base.noise = None
    fewer = {"gain": 0.0}
    problem = SimpleNamespace(solution=lambda values, samples, noise: model(fewer["gain"], 4))
    made = candidates(fitted=lambda effects: SimpleNamespace(problem=problem))
    told(monkeypatch, search=search, noise_at=lambda problem, samples, values: None)
    for there, wanted in ((0.0, 80.0), (200.0, 30.0), (-200.0, 80.0), (400.0, -20.0)):
        fewer["gain"] = there
        assert evidence_alone(made, rich, base) == pytest.approx(wanted)
    # However little evidence there is, it is asked.
    slight = model(82.0, 5)
    slight.samples, fewer["gain"] = "few", 200.0
    assert evidence(made, slight, base) == pytest.approx(0.5)
    assert evidence_alone(made, slight, base) == pytest.approx(-118.0 - 20.0)
    assert set(asked) == {"few"}
    # Of the same samples, or without evidence, nothing is asked.
    count = len(asked)
    same = model(400.0, 5)
    assert evidence_alone(made, same, base) == 80.0
    low = model(40.0, 5)
    low.samples = "few"
    assert evidence_alone(made, low, base) == -10.0
    assert len(asked) == count


# ---- exchanges ---------------------------------------------------------------------------------

WHOLE = model(1000.0, 5)
NEAR = model(0.0, 4)


def cost(gain: float, free: int = 5) -> float:
    """Half of what is lost in likelihood, and what it is dearer."""
    return 0.5 * (1000.0 - gain) + PRICE * (free - 5)


def swapped(
    monkeypatch: pytest.MonkeyPatch,
    *,
    score: float = 1e4,
    looked: float = 900.0,
    promised: float = 1000.0,
    ranked: float = 950.0,
    converged: float = 990.0,
    rms_n: float = 1.0,
    alone: float = 1.0,
    effects: tuple[str, ...] = ("a", "b"),
) -> tuple[float, list[str]]:
    """What an exchange costs, and how far it was followed."""
    said: list[str] = []

    def step(name: str, found: Any) -> Any:
        said.append(name)
        return found

    look = SimpleNamespace(promised=promised, found=lambda: model(looked, 5))
    made = candidates(
        score_test=lambda effects, near: score,
        look=lambda effects, near: step("look", look),
        rank=lambda effects, near: step("rank", model(ranked, 5)),
        converge=lambda effects, near: step("converge", model(converged, 5, rms_n)),
    )
    told(monkeypatch, evidence_alone=lambda c, richer, simpler: alone)
    return swap_cost(made, effects, WHOLE, NEAR), said


def test_an_exchange_costs_what_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    assert swapped(monkeypatch) == (cost(990.0), ["look", "rank", "converge"])
    # What is worth nothing beside the rest stands for nothing.
    assert swapped(monkeypatch, alone=0.0) == (cost(0.0, 4), ["look", "rank", "converge"])


@pytest.mark.parametrize(
    ("score", "followed"),
    [
        # Three tenths of a price of 20, beside which the law's own step of 3 is none of it.
        (DEFAULT.least_score * PRICE, False),
        # A twentieth of what the effect itself gains, and that step.
        (DEFAULT.least_swap * 1000.0 + 3.0, False),
        (DEFAULT.least_swap * 1000.0 + 3.1, True),
    ],
)
def test_what_does_not_show_in_its_score_is_not_followed(
    score: float, followed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, said = swapped(monkeypatch, score=score)
    assert bool(said) == followed
    assert followed or found == cost(0.0, 4)


@pytest.mark.parametrize(("more", "followed"), [(-1.0, False), (0.0, False), (1.0, True)])
def test_what_could_not_come_near_is_not_followed(
    more: float, followed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its cost, less half of what it could gain yet: twice what is promised less what it has."""
    looked = 300.0
    # cost(300) = 350; at the contender's 60 it could gain 580, and has 300: 440 promised.
    promised = ((cost(looked) - DEFAULT.contender) / 0.5 + looked + more) / DEFAULT.foreseen
    found, said = swapped(monkeypatch, looked=looked, promised=promised)
    assert (said != ["look"]) == followed
    assert followed or found == cost(looked)
    # Of peak beside peak no look tells.
    peaks, said = swapped(monkeypatch, looked=looked, promised=promised, effects=("peaks",))
    assert said == ["rank", "converge"]
    assert peaks == cost(990.0)


@pytest.mark.parametrize(("more", "followed"), [(-0.1, False), (0.0, False), (0.1, True)])
def test_what_ranks_behind_does_not_converge(
    more: float, followed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    ranked = 1000.0 - 2.0 * DEFAULT.contender + more
    found, said = swapped(monkeypatch, ranked=ranked)
    assert (said[-1] == "converge") == followed
    assert found == (cost(990.0) if followed else pytest.approx(cost(ranked)))


@pytest.mark.parametrize(("part", "stands"), [(0.999, True), (1.0, True), (1.001, False)])
def test_what_leaves_far_more_stands_for_nothing(
    part: float, stands: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, _ = swapped(monkeypatch, rms_n=part * DEFAULT.leader_rms)
    assert found == (cost(990.0) if stands else np.inf)
