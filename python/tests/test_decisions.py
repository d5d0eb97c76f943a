"""The verdict and what leads to it, each rule as a table; numbers on either side of each line."""

from __future__ import annotations

from itertools import combinations
from typing import cast

import numpy as np
import pytest
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.confirmation import left_out_confirms
from jbf.diagnosis.evidence import evidence
from jbf.diagnosis.ledger import Step, Trial
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.rounds import select
from jbf.diagnosis.standing import as_it_ended
from jbf.diagnosis.verdict import name_stands, verdict
from jbf.estimation.likelihood import independent_share, likelihood_gain
from made_up import MadeUp, N, price, sets, solution
from scipy import signal


@pytest.mark.parametrize(
    ("effects", "alternatives", "remains", "said"),
    [
        (0, 0, False, "adequate"),
        (1, 0, False, "missing"),
        (3, 0, False, "missing"),
        (1, 1, False, "ambiguous"),
        (2, 1, False, "ambiguous"),
        (0, 0, True, "unexplained"),
        (1, 0, True, "unexplained"),
        (1, 1, True, "unexplained"),
    ],
)
def test_the_verdict(effects: int, alternatives: int, remains: bool, said: str) -> None:
    assert verdict(effects=effects, alternatives=alternatives, remains=remains) == said


@pytest.mark.parametrize(
    ("disagreement", "stands"),
    # A gain of 1000 is 20 times 50.
    [(None, True), (49.0, True), (51.0, False)],
)
def test_a_name_falls_by_its_own_runs_alone(disagreement: float | None, stands: bool) -> None:
    assert name_stands(1000.0, disagreement, DEFAULT) == stands


def test_the_ledger_says_how_each_addition_ended() -> None:
    tried = [Trial(name, 1.0, 9.0, "added", "leads") for name in ("a", "b", "c")]
    steps = [Step((), 2.0, 2.0, 1.0, (tried[0],)), Step(("a",), 1.0, 1.0, 1.0, tuple(tried[1:]))]
    ended = as_it_ended(steps, ("a", "b"), ("b",))
    assert [s.effects for s in ended] == [(), ("a",)]
    outcomes = {t.effect: t.outcome for s in ended for t in s.trials}
    assert outcomes == {"a": "added", "b": "confounder", "c": "replaced"}
    assert all(t.reason != "leads" for t in ended[1].trials)


@pytest.mark.parametrize(
    ("strength", "density", "share", "better", "confirmed"),
    [
        (59.0, 0.51, -9.0, 0.0, True),
        (59.0, 0.49, 1.0, 1.0, False),
        (61.0, -1.0, 0.01, 0.0, True),
        (61.0, 1.0, 0.0, 0.5, False),
        (61.0, -1.0, -9.0, 2.0 / 3.0, True),
    ],
)
def test_what_left_out_runs_must_confirm(
    strength: float, density: float, share: float, better: float, confirmed: bool
) -> None:
    assert left_out_confirms(strength, density, share, better, DEFAULT) == confirmed
    # Far worse as a whole is no confirmation, in however many runs it is better.
    assert not left_out_confirms(strength, density, share, better, DEFAULT, 1.3)


# ---- evidence ---------------------------------------------------------------------------------


def test_evidence_of_made_up_models() -> None:
    candidates = cast(Candidates, MadeUp(["sensor_lag", "sensor_drift"], {}))
    bare, one = solution((), 0.0), solution(("sensor_lag",), 100.0)
    two = solution(("sensor_lag", "sensor_drift"), 150.0)
    assert likelihood_gain(one, bare) == pytest.approx(100.0)
    assert likelihood_gain(bare, two) == pytest.approx(-150.0)
    assert evidence(candidates, one, bare) == pytest.approx(100.0 - price(1, 2))
    assert evidence(candidates, two, bare) == pytest.approx(150.0 - price(2, 2))
    smooth = solution(("sensor_lag",), 100.0, smooth=3)
    assert evidence(candidates, smooth, bare) == pytest.approx(0.6 * 100.0 - price(1, 2), abs=0.5)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_of_a_first_order_process_few_samples_are_independent(phi: float) -> None:
    # Bartlett (1946): 1 + 2 (phi + phi^2 + ...) = (1 + phi) / (1 - phi) samples make one.
    shares = []
    for seed in range(5):
        kicks = np.random.default_rng(seed).standard_normal((2, 20_000))
        runs = [signal.lfilter([1.0], [1.0, -phi], row) for row in kicks]
        shares.append(independent_share(runs, [0.005, 0.005]))
    assert np.mean(shares) == pytest.approx((1.0 - phi) / (1.0 + phi), rel=0.12, abs=0.01)
    assert independent_share([np.zeros(50)], [0.02]) == 1.0


# ---- rounds -----------------------------------------------------------------------------------

SIX = (
    "sensor_offset",
    "sensor_drift",
    "sensor_lag",
    "inertia_leak",
    "quadratic_drag",
    "wear_in",
)


def additive(gain: float = 200.0) -> dict[frozenset[str], float]:
    """Six effects, each of which gains as much beside any others; the first a little more."""
    worth = {name: gain - i for i, name in enumerate(SIX)}
    every = [s for k in range(len(SIX) + 1) for s in combinations(SIX, k)]
    return {frozenset(s): sum(worth[name] for name in s) for s in every}


def test_rounds_add_one_effect_after_another_up_to_five() -> None:
    candidates = cast(Candidates, MadeUp(list(SIX), additive()))
    found = select(candidates, 0.5)
    present, steps, refused = found.present, found.steps, found.refused
    assert present == SIX[:5]
    assert [s.effects for s in steps] == [SIX[:k] for k in range(6)]
    # The sixth that would lead is not lost.
    assert [r.where.split()[0] for r in refused] == [SIX[5]]
    assert all(s.noise_n == 0.5 for s in steps)
    rms = [s.rms_n for s in steps]
    assert rms == sorted(rms, reverse=True)


def test_rounds_end_where_nothing_gains_more_than_chance() -> None:
    gains = {s: g for s, g in additive().items() if len(s) <= 2}
    found = select(cast(Candidates, MadeUp(list(SIX), gains)), 0.5)
    present, steps = found.present, found.steps
    assert present == SIX[:2]
    assert len(steps) == 3
    assert {t.outcome for t in steps[-1].trials} == {"no gain"}


def test_a_stand_in_found_first_goes_when_the_truth_is_whole() -> None:
    gains = {
        "": 0.0,
        "sensor_lag": 300.0,
        "sensor_offset": 200.0,
        "sensor_drift": 190.0,
        "sensor_lag sensor_offset": 400.0,
        "sensor_lag sensor_drift": 380.0,
        "sensor_offset sensor_drift": 350.0,
        "sensor_lag sensor_offset sensor_drift": 500.0,
    }
    found = MadeUp(list(SIX[:3]), sets(gains), from_richer={frozenset(SIX[:2]): 495.0})
    assert set(select(cast(Candidates, found), 0.5).present) == {"sensor_offset", "sensor_drift"}


@pytest.mark.parametrize(("strength", "told"), [(61.0, True), (59.0, False)])
def test_what_fits_and_does_not_predict_is_structure(strength: float, told: bool) -> None:
    gains = {"": 0.0, "sensor_lag": price(1, 2) + strength}
    left_out = {frozenset[str](): 2.0, frozenset(["sensor_lag"]): 2.1}
    found = MadeUp(["sensor_lag", "sensor_drift"], sets(gains), left_out=left_out)
    selected = select(cast(Candidates, found), 0.5)
    refused = selected.refused
    assert selected.present == ()
    assert selected.steps[0].trials[0].outcome == "rejected"
    assert [r.axis for r in refused] == (["run"] if told else [])
    if told:
        assert "sensor_lag fits 2 N down to 1.9" in refused[0].where
        assert refused[0].share == pytest.approx(1.0 - np.exp(-gains["sensor_lag"] / N))
