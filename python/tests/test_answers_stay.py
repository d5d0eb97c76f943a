"""What a comparison or a diagnosis hands over stays what it is, and is told in its own words."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields
from typing import Any

import pytest
from jbf.comparison.bins import Bin, Binned
from jbf.comparison.comparison import Comparison, RunComparison
from jbf.comparison.over_speed import OverSpeed
from jbf.comparison.patterns import Failure
from jbf.diagnosis.alone import Change
from jbf.diagnosis.check import Answer, Check, Rate, _Task
from jbf.diagnosis.confirmation import Confirmation
from jbf.diagnosis.constancy import Disagreement
from jbf.diagnosis.deviations import Deviation
from jbf.diagnosis.excitations import Excitation, Limits
from jbf.diagnosis.experiment import Experiment
from jbf.diagnosis.ledger import Remainder, Step, Trial
from jbf.diagnosis.level import Directions, Level
from jbf.diagnosis.one_round import OneRound
from jbf.diagnosis.plan import Plan
from jbf.diagnosis.planned import PlannedPower
from jbf.diagnosis.policy import Policy
from jbf.diagnosis.power import Power, _Seen
from jbf.diagnosis.result import Diagnosis
from jbf.diagnosis.rounds import Selected
from jbf.diagnosis.second_look import SecondLook
from jbf.diagnosis.selection import Ranked, Round
from jbf.diagnosis.shifted import Shifted
from jbf.diagnosis.strength import Strength
from jbf.diagnosis.which_law import LawTried
from jbf.results import Result

RESULTS: list[Any] = [Check, Comparison, Diagnosis, Plan, PlannedPower]
BY_IDENTITY: list[Any] = [Change, Deviation, Directions, SecondLook, Shifted]
KINDS: list[Any] = [
    *RESULTS, *BY_IDENTITY, Answer, Bin, Binned, Confirmation, Disagreement, Excitation, Experiment,
    Failure, LawTried, Level, Limits, OneRound, OverSpeed, Policy, Power, Ranked, Rate, Remainder,
    Round, RunComparison, Selected, Step, Strength, Trial, _Seen, _Task,
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_no_field_is_written_to(kind: Any) -> None:
    """Candidates, rounds and pages share it."""
    made = object.__new__(kind)
    with pytest.raises(FrozenInstanceError):
        setattr(made, fields(kind)[0].name, None)


@pytest.mark.parametrize("kind", BY_IDENTITY)
def test_what_holds_arrays_is_alike_only_to_itself(kind: Any) -> None:
    """Arrays have no truth of their own; what holds them may be a key all the same."""
    one, other = object.__new__(kind), object.__new__(kind)
    assert one != other
    assert len({one: 1, other: 2}) == 2


@pytest.mark.parametrize("kind", RESULTS)
def test_a_result_shows_itself_as_every_result_does(kind: Any) -> None:
    """Not as a constructor's call with all its arrays."""
    assert kind.__repr__ is Result.__repr__
