"""What is handed over stays what it is: nobody changes a record, a rig, a finding or a setting that
somebody else holds."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, fields, is_dataclass
from typing import Any

import pytest
from jbf.control.bench import Bench
from jbf.control.robustness import Case, Outcome
from jbf.control.run import Result
from jbf.control.schemes.carried import Observed, Table
from jbf.control.schemes.learning import Learning
from jbf.control.schemes.plain import Coulomb, NoCompensation, Repetitive
from jbf.control.settings import Settings
from jbf.control.task import Task
from jbf.control.thesis_tables import Cell, Tables
from jbf.records.drive import Drive
from jbf.records.drive_columns import DriveColumns
from jbf.records.findings.examine import Examined
from jbf.records.findings.finding import Finding
from jbf.records.findings.interpolated import Native, _Looks
from jbf.records.motion.believed import Believed
from jbf.records.motion.compared import Compared
from jbf.records.motion.imposed import ImposedMotion
from jbf.records.motion.position import Position
from jbf.records.motion.units import Mismatch
from jbf.records.quantities import Quantities
from jbf.records.rig import Bearing, Load, Lubricant, Rig
from jbf.records.run import Run
from jbf.reporting.advice import Advice
from jbf.reporting.diagnosis_page import Round
from jbf.reporting.gallery import Card

KINDS: list[Any] = [
    Bench, Case, Outcome, Result, Observed, Table, Learning, Coulomb, NoCompensation, Repetitive,
    Settings, Task, Cell, Tables, Drive, DriveColumns, Examined, Finding, Native, _Looks, Believed,
    Compared, ImposedMotion, Position, Mismatch, Quantities, Bearing, Load, Lubricant, Rig, Run,
    Advice, Round, Card,
]  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_no_field_is_written_to(kind: Any) -> None:
    """Nor a new one added, nor one deleted."""
    made = object.__new__(kind)
    assert is_dataclass(made)
    for name in (fields(kind)[0].name, "another"):
        with pytest.raises(FrozenInstanceError):
            setattr(made, name, None)
    with pytest.raises(FrozenInstanceError):
        delattr(made, fields(kind)[0].name)


@pytest.mark.parametrize("kind", [Run, Result, Examined, Believed])
def test_records_are_alike_only_to_themselves(kind: Any) -> None:
    """Arrays have no truth of their own; a record may be a key all the same."""
    one, other = object.__new__(kind), object.__new__(kind)
    assert one != other
    assert len({one: 1, other: 2}) == 2


def test_a_finding_as_data() -> None:
    """Every field by its name."""
    told = Finding("gaps", "time_s", "a", 0.1, "s", "stepped over", "words").to_dict()
    assert told == {"kind": "gaps", "channel": "time_s", "run": "a", "size": 0.1, "unit": "s",
                    "done": "stepped over", "words": "words"}  # fmt: skip
