"""What could stand in an effect's place, and by what posterior weight: on made-up likelihoods."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, cast

import pytest
from jbf.diagnosis.candidates import Candidates
from jbf.diagnosis.policy import DEFAULT
from jbf.diagnosis.selection import weights
from jbf.estimation.likelihood import effective_share
from made_up import MadeUp, sets, solution

FOUR = ["sensor_offset", "sensor_drift", "sensor_lag", "inertia_leak"]


def made(gains: dict[str, float], **more: Any) -> MadeUp:
    return MadeUp(FOUR, sets({"": 0.0} | gains), **more)


def weighed(candidates: MadeUp) -> dict[str, float]:
    return weights(cast(Candidates, candidates), ("sensor_lag",))["sensor_lag"]


def test_alternatives_are_those_that_would_fit_as_well_by_their_posterior_weight() -> None:
    candidates = made({"sensor_lag": 300.0, "sensor_drift": 293.0, "sensor_offset": 291.0})
    # Odds are those of the likelihoods; all three have one parameter.
    odds = math.exp(-3.5)
    assert weighed(candidates) == pytest.approx(
        {"sensor_lag": 1.0 / (1.0 + odds), "sensor_drift": odds / (1.0 + odds)}
    )
    wide = replace(candidates, policy=replace(DEFAULT, least_weight=0.01))
    found = weighed(wide)
    assert list(found) == ["sensor_lag", "sensor_drift", "sensor_offset"]
    assert sum(found.values()) == pytest.approx(1.0)
    assert found["sensor_offset"] / found["sensor_lag"] == pytest.approx(math.exp(-4.5))


def test_one_that_fits_better_weighs_more() -> None:
    candidates = made({"sensor_lag": 300.0, "sensor_drift": 304.0})
    assert weighed(candidates)["sensor_drift"] == pytest.approx(1.0 / (1.0 + math.exp(-2.0)))


def test_where_the_error_is_smooth_samples_say_less_of_rivals_too() -> None:
    gains = {"sensor_lag": 300.0, "sensor_drift": 294.0}
    whole = solution(["sensor_lag"], 300.0, smooth=3)
    share = effective_share(whole)
    assert 0.2 < share < 0.8
    odds = math.exp(-0.5 * share * 6.0)
    found = weighed(replace(made(gains), smooth=3))
    assert found["sensor_drift"] == pytest.approx(odds / (1.0 + odds))


def test_one_that_fits_far_better_weighs_all() -> None:
    candidates = made({"sensor_lag": 300.0, "sensor_drift": 9000.0})
    assert weighed(candidates) == pytest.approx({"sensor_lag": 0.0, "sensor_drift": 1.0})


def test_an_alternative_whose_score_promises_nothing_is_none() -> None:
    candidates = made(
        {"sensor_lag": 300.0, "sensor_drift": 300.0}, scores={frozenset(["sensor_drift"]): 5.0}
    )
    assert weighed(candidates) == {"sensor_lag": 1.0}
