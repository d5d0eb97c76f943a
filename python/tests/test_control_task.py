"""The programs of chapter 6, number by number; what is a task and what is none."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from jbf.control.task import RECORDED, TASKS, WAVES, Task
from jbf.errors import InputError

PROGRAMS = {
    # Wave, lowest and highest reference (rad or rad/s), rad/s, largest speed asked for (rad/s).
    "position triangle": ("triangle", 0.0, 10.4, 0.628, 10.4 / 3.141592653589793 * 0.628),
    "position square": ("square", -1.04, 1.04, 0.25, 0.0),
    "position sine": ("sine", -1.04, 1.04, 0.25, 0.26),
    "velocity sine": ("sine", -1.04, 1.04, 0.25, 1.04),
    "velocity triangle": ("triangle", -2.08, 2.08, 0.5, 2.08),
    "velocity square": ("square", -1.04, 1.04, 0.25, 1.04),
    "velocity sine 20.8": ("sine", 0.52, 20.8, 0.25, 20.8),
}


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_a_program_is_the_thesiss(name: str) -> None:
    """Waves, ends, frequencies, speeds; in velocity control the first two seconds are left out."""
    task, (wave, low, high, frequency, top) = TASKS[name], PROGRAMS[name]
    assert (task.wave, task.low, task.high) == (wave, low, high)
    assert task.frequency_rad_s == frequency
    assert task.top_speed_rad_s == pytest.approx(top)
    assert task.is_position == name.startswith("position")
    assert task.unit == ("rad" if task.is_position else "rad/s")
    assert task.period_s == pytest.approx(2.0 * math.pi / frequency)
    counted = (50.0, 0.0) if task.is_position else (52.0, 2.0)
    assert (task.seconds, task.skip_s) == counted
    assert set(TASKS) == set(PROGRAMS)


def test_a_task_has_a_length_unless_one_is_given() -> None:
    """Fifty seconds, all of which count; once made it stays what it is."""
    task = Task("position", "sine", -1.0, 1.0, 1.0)
    assert (task.seconds, task.skip_s) == (50.0, 0.0)
    with pytest.raises(AttributeError):
        task.low = 0.0  # type: ignore[misc]


SINE = Task("position", "sine", -1.0, 2.0, 0.5, 10.0, 1.0)


@pytest.mark.parametrize(
    ("change", "top"),
    [
        ({}, 0.75),
        ({"wave": "triangle"}, 1.5 / math.pi),
        ({"wave": RECORDED}, 1.5 / math.pi),
        ({"wave": "square"}, 0.0),
        ({"control": "velocity"}, 2.0),
        ({"control": "velocity", "low": -3.0}, 3.0),
        ({"control": "velocity", "wave": "square", "low": -3.0}, 3.0),
        ({"low": 1.0}, 0.25),
    ],
)
def test_the_largest_speed_that_a_reference_asks_for(change: dict[str, Any], top: float) -> None:
    """Half the span times the frequency of a sine; of a triangle its slope; of a jump none."""
    assert replace(SINE, **change).top_speed_rad_s == pytest.approx(top)


@pytest.mark.parametrize(
    "change",
    [
        {"low": -1e6},
        {"high": 1e6},
        {"low": 2.0 - 1e-9},
        {"frequency_rad_s": 1e-300},
        {"skip_s": 0.0},
        {"skip_s": 9.999},
        {"seconds": 1e5},
        {"wave": RECORDED},
        *({"wave": wave} for wave in WAVES),
    ],
)
def test_what_is_just_a_task(change: dict[str, Any]) -> None:
    """Ends of each range that belong to it."""
    task = replace(SINE, **change)
    assert all(getattr(task, name) == value for name, value in change.items())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"control": "force"}, 'control "force" is not known; write position or velocity'),
        ({"wave": "sin"}, 'there is no wave "sin"; did you mean "sine"?'),
        ({"low": -1.0001e6}, "low -1000100.0 and high 2.0 are no range"),
        ({"high": 1.0001e6}, "low -1.0 and high 1000100.0 are no range"),
        ({"low": 2.0}, "low 2.0 and high 2.0 are no range; give low below high, within a million"),
        ({"high": math.nan}, "low -1.0 and high nan are no range"),
        ({"frequency_rad_s": 0.0}, "frequency 0.0 rad/s is not above zero; correct it"),
        ({"frequency_rad_s": math.inf}, "frequency inf rad/s is not above zero"),
        ({"skip_s": -1e-9}, "10.0 s with -1e-09 s left out is no run"),
        ({"skip_s": 10.0}, "10.0 s with 10.0 s left out is no run; give up to 100,000 s"),
        ({"seconds": 100000.1}, "100000.1 s with 1.0 s left out is no run"),
        ({"seconds": 0.0, "skip_s": 0.0}, "0.0 s with 0.0 s left out is no run"),
    ],
)
def test_what_is_no_task(change: dict[str, Any], said: str) -> None:
    """Just beyond each range, and what is said of it."""
    with pytest.raises(InputError) as refused:
        replace(SINE, **change)
    assert said in str(refused.value)
