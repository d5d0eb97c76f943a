"""Rules of selection that few rounds come to: further effects, near ties, and who may lead."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.selection import AHEAD, reconsider, still_needed, try_candidates, weights
from made_up import MadeUp, price, sets

WAVES = ["cogging", "cogging_2", "sensor_lag", "sensor_drift"]
PRICE = price(1, 4)


def made(gains: dict[str, float], names: list[str] = WAVES, **more: Any) -> Any:
    return cast(Candidates, MadeUp(names, sets({"": 0.0} | gains), **more))


# ---- a further one of an effect ----------------------------------------------------------------


def test_a_further_effect_is_tried_beside_its_first_one_alone() -> None:
    gains = {"cogging_2": 900.0, "cogging": 300.0, "cogging cogging_2": 600.0}
    first = try_candidates(made(gains), ())
    assert first.leader == "cogging"
    assert sorted(t.effect for t in first.trials) == ["cogging", "sensor_drift", "sensor_lag"]
    assert try_candidates(made(gains), ("cogging",)).leader == "cogging_2"


@pytest.mark.parametrize("first_gains", [0.0, 400.0])
def test_a_first_effect_stays_while_a_further_one_is_there(first_gains: float) -> None:
    """Though the further one says all of it."""
    gains = {"cogging": first_gains, "cogging_2": 900.0, "cogging cogging_2": 900.0}
    present = ("cogging", "cogging_2")
    assert reconsider(made(gains), present) == present
    assert still_needed(made(gains), present) == present


def test_once_the_further_one_is_gone_the_first_may_go() -> None:
    gains = {"sensor_lag": 500.0, "cogging sensor_lag": 501.0, "cogging cogging_2": 1.0}
    gains |= {"cogging cogging_2 sensor_lag": 502.0}
    assert still_needed(made(gains), ("cogging_2", "cogging", "sensor_lag")) == ("sensor_lag",)
    assert reconsider(made(gains), ("cogging_2", "cogging", "sensor_lag")) == ("sensor_lag",)


def test_a_further_effect_stands_in_no_others_place() -> None:
    gains = {"sensor_lag": 300.0, "sensor_drift": 300.0, "sensor_lag sensor_drift": 600.0}
    gains |= {"cogging_2 sensor_drift": 900.0, "cogging_2": 900.0}
    assert reconsider(made(gains), ("sensor_lag", "sensor_drift")) == ("sensor_lag", "sensor_drift")
    assert list(weights(made(gains), ("sensor_lag",))["sensor_lag"]) == [
        "sensor_lag",
        "sensor_drift",
    ]


# ---- of two that are one -----------------------------------------------------------------------


@pytest.mark.parametrize(("more", "leader"), [(0.03, "sensor_drift"), (0.2, "sensor_lag")])
def test_of_two_within_a_tenth_the_one_nearer_to_the_record_leads(more: float, leader: str) -> None:
    """A tenth of the evidence, in twice the log likelihood: nobody could tell."""
    gains = {"sensor_lag": PRICE + 100.0 + more, "sensor_drift": PRICE + 100.0}
    assert try_candidates(made(gains), ()).leader == leader


# ---- who may lead by a first look --------------------------------------------------------------

SIX = ["sensor_offset", "sensor_drift", "sensor_lag", "inertia_leak", "wear_in", "backlash"]


@pytest.mark.parametrize(("idle", "left_behind"), [(AHEAD - 1, True), (AHEAD, False)])
def test_one_of_the_three_that_gained_most_may_lead(idle: int, left_behind: bool) -> None:
    """Those at their null have no evidence; one after the third is not looked at for it."""
    assert AHEAD == 3
    gains = {name: 500.0 - 10.0 * i for i, name in enumerate(SIX[:5])}
    nulls = sets(dict.fromkeys(SIX[:idle], 0.0))
    candidates = made(gains, SIX, nulls=nulls, promised=sets({"backlash": 10.0}))
    try_candidates(candidates, ())
    looks = [effects for what, effects in candidates.asked if what == "rank"]
    assert (frozenset(["backlash"]) not in looks) == left_behind


# ---- what it is worth --------------------------------------------------------------------------


def test_no_candidate_is_worse_than_its_null() -> None:
    """A fit that lost its way loses no more than the price of its parameter."""
    lost = made({"sensor_lag": -50.0, "sensor_drift": 300.0})
    trial = next(t for t in try_candidates(lost, ()).trials if t.effect == "sensor_lag")
    assert trial.evidence == pytest.approx(-PRICE)


def test_weights_are_odds_of_half_the_evidence_that_an_exchange_loses() -> None:
    gains = {"sensor_lag": 300.0, "sensor_drift": 298.0, "cogging": 293.0}
    found = weights(made(gains), ("sensor_lag",))["sensor_lag"]
    odds = np.exp([0.0, -1.0, -3.5])
    assert list(found) == ["sensor_lag", "sensor_drift", "cogging"]
    assert list(found.values()) == pytest.approx(odds / odds.sum(), rel=1e-4)
