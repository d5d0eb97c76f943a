"""The constants behind a verdict: accepted values, and the effect of each on a diagnosis."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from by_hand import four_runs
from jbf import Diagnosis, InputError, Rig, diagnose
from jbf.diagnosis import Policy
from jbf.diagnosis.policy import DEFAULT
from linear_campaigns import CANDIDATES, Textbook, linear_diagnosis, linear_runs, offset_and_drag
from scipy import stats


def diagnosis_with(hidden: str, **changes: Any) -> Diagnosis:
    """The diagnosis of a linear campaign under a changed policy."""
    return diagnose(Rig(), linear_runs(hidden), law="coulomb", policy=replace(DEFAULT, **changes))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("weak", math.nan),
        ("false_alarms", math.nan),
        ("false_alarms", 0.0),
        ("false_alarms", 1.0),
        ("least_weight", 0.0),
        ("least_weight", 0.5),
    ],
)
def test_value_outside_its_range_is_rejected_by_name(name: str, value: float) -> None:
    changes: dict[str, Any] = {name: value}
    with pytest.raises(InputError, match=name):
        replace(DEFAULT, **changes)


@pytest.mark.parametrize("weight", [0.018, 0.1, 0.4])
def test_evidence_margin_of_a_tie_is_twice_the_log_odds_against_the_least_weight(
    weight: float,
) -> None:
    assert Policy(least_weight=weight).tie == pytest.approx(2.0 * np.log((1.0 - weight) / weight))


# ---- thresholds ---------------------------------------------------------------------------------


def _margins() -> list[Any]:
    """Values of the constants at which the gain of the weak mass equals its threshold."""
    book = Textbook(linear_runs("weak mass"))
    gain, rms_n = book.gain(), book.rms(2)
    at_chance = stats.chi2.isf(0.01 / CANDIDATES, 1)
    rate = CANDIDATES * stats.chi2.sf(gain - 22.0, 1)
    share = np.sqrt(gain / book.samples)
    extended = pytest.mark.extended
    return [
        pytest.param("imperfection", gain - at_chance, id="artefact margin"),
        pytest.param("false_alarms", rate, id="false-alarm rate", marks=extended),
        pytest.param("indifference", share, id="minimum effect size", marks=extended),
        pytest.param("indifference_n", rms_n * share, id="minimum effect in N", marks=extended),
    ]


@pytest.mark.parametrize(("name", "at_gain"), _margins())
def test_effect_is_named_only_if_its_gain_exceeds_the_threshold(name: str, at_gain: float) -> None:
    factor = {"false_alarms": 0.1, "imperfection": 1.15}.get(name, 1.1)
    named = diagnosis_with("weak mass", **{name: at_gain / factor})
    silent = diagnosis_with("weak mass", **{name: at_gain * factor})
    assert (named.verdict, named.effects) == ("missing", ("inertia_leak",))
    assert (silent.verdict, silent.effects) == ("adequate", ())
    assert getattr(silent.policy, name) == silent.to_dict()["policy"][name]


def test_search_stops_at_the_largest_number_of_effects_and_reports_the_next_one() -> None:
    runs = four_runs(offset_and_drag, noise_n=0.1)
    policy = replace(DEFAULT, most_effects=1)
    found = diagnose(Rig(), runs, law="coulomb", policy=policy)
    assert found.verdict == "unexplained"
    assert len(found.model.effects) == 1
    assert "effects" in [remainder.axis for remainder in found.unexplained]


@pytest.mark.extended
def test_alternative_below_the_least_weight_is_dropped() -> None:
    tied = linear_diagnosis("lag")
    (effect,) = tied.effects
    (other,) = tied.alternatives[effect]
    weight = min(tied.weights[effect][other], tied.weights[effect][effect])
    assert DEFAULT.least_weight < weight < 0.49
    dropped = diagnosis_with("lag", least_weight=1.02 * weight)
    assert (dropped.verdict, len(dropped.effects)) == ("missing", 1)
    assert dropped.alternatives == {dropped.effects[0]: ()}
