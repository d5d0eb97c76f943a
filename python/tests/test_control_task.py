"""The programs of chapter 6, number by number."""

from __future__ import annotations

import pytest
from jbf.control.task import TASKS

PROGRAMS = {
    # Wave, lowest and highest reference (rad or rad/s), rad/s, largest speed asked for (rad/s).
    "position triangle": ("triangle", 0.0, 10.4, 0.628, 10.4 / 3.141592653589793 * 0.628),
    "position square": ("square", -1.04, 1.04, 0.25, 0.0),
    "position sine": ("sine", -1.04, 1.04, 0.25, 0.26),
    "velocity sine": ("sine", -1.04, 1.04, 0.25, 1.04),
    "velocity triangle": ("triangle", -2.08, 2.08, 0.5, 2.08),
    "velocity square": ("square", -1.04, 1.04, 0.25, 1.04),
}


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_a_program_is_the_thesiss(name: str) -> None:
    task, (wave, low, high, frequency, top) = TASKS[name], PROGRAMS[name]
    assert (task.wave, task.low, task.high) == (wave, low, high)
    assert task.frequency_rad_s == frequency
    assert task.top_speed_rad_s == pytest.approx(top)
    assert task.is_position == name.startswith("position")
    assert task.unit == ("rad" if task.is_position else "rad/s")
