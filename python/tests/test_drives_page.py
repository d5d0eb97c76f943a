"""docs/drives.md names every key, every column and every effect that goes with a drive."""

from __future__ import annotations

import re
from pathlib import Path

import jbf
from jbf.records.drive import Drive
from jbf.records.drive_columns import DriveColumns

PAGE = Path(__file__).resolve().parents[2] / "docs" / "drives.md"


def test_the_page_names_every_key_and_column() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for name in Drive.__dataclass_fields__:
        assert f"`{name}`" in text, name
    drives = (
        Drive("rotary", "torque"),
        Drive("rotary", "current", torque_constant_n_m_a=1.0),
        Drive("rotary", "percent", rated_torque_n_m=1.0),
        Drive("linear", "force", pitch_m=0.01),
        Drive("linear", "percent", rated_force_n=1.0),
    )
    for drive in drives:
        for column in DriveColumns.of(drive).known:
            assert f"`{column}`" in text, column


def test_the_page_names_only_effects_that_go_with_a_drive() -> None:
    section = PAGE.read_text(encoding="utf-8").partition("## What the effects are here")[2]
    rows = re.findall(r"^\| (`.*?) \|", section, flags=re.MULTILINE)
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    known = jbf.effects()
    assert named
    for name in named:
        assert "coulomb" not in known[name].refused
    # What only drives have stands there without exception.
    assert {name for name, page in known.items() if "journal" in page.refused} <= named
