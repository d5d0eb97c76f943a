"""Tasks of the control loop: programs of the thesis, derived quantities, and invalid values."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from jbf import InputError
from jbf.control import TASKS, THESIS_BENCH, Task, run

PROGRAMS = {
    # Wave, lowest and highest reference (rad or rad/s), frequency (rad/s), largest speed (rad/s).
    "position triangle": ("triangle", 0.0, 10.4, 0.628, 10.4 / math.pi * 0.628),
    "position square": ("square", -1.04, 1.04, 0.25, 0.0),
    "position sine": ("sine", -1.04, 1.04, 0.25, 0.26),
    "velocity sine": ("sine", -1.04, 1.04, 0.25, 1.04),
    "velocity triangle": ("triangle", -2.08, 2.08, 0.5, 2.08),
    "velocity square": ("square", -1.04, 1.04, 0.25, 1.04),
    "velocity sine 20.8": ("sine", 0.52, 20.8, 0.25, 20.8),
}


@pytest.mark.parametrize("name", list(PROGRAMS))
def test_predefined_task_agrees_with_chapter_six_of_the_thesis(name: str) -> None:
    task, (wave, low, high, frequency, top) = TASKS[name], PROGRAMS[name]
    assert (task.wave, task.low, task.high, task.frequency_rad_s) == (wave, low, high, frequency)
    assert task.top_speed_rad_s == pytest.approx(top)
    assert task.is_position == name.startswith("position")
    assert task.unit == ("rad" if task.is_position else "rad/s")
    # The first two seconds are skipped in velocity control.
    assert (task.seconds, task.skip_s) == ((50.0, 0.0) if task.is_position else (52.0, 2.0))
    assert set(TASKS) == set(PROGRAMS)


@pytest.mark.parametrize("control", ["position", "velocity"])
@pytest.mark.parametrize("wave", ["sine", "triangle"])
def test_top_speed_and_period_of_a_task_are_those_of_its_reference(control: str, wave: str) -> None:
    task = Task(control, wave, -2.1, 0.7, 0.8, seconds=20.0)  # type: ignore[arg-type]
    reference = run(None, "none", task).reference
    speed = np.diff(reference) / THESIS_BENCH.dt_s if task.is_position else reference
    assert task.top_speed_rad_s == pytest.approx(np.max(np.abs(speed)), rel=1e-3)
    assert (np.min(reference), np.max(reference)) == pytest.approx((-2.1, 0.7), abs=1e-2)
    assert task.period_s == pytest.approx(2.0 * math.pi / 0.8)
    lap = round(task.period_s / THESIS_BENCH.dt_s)
    assert reference[lap:] == pytest.approx(reference[:-lap], abs=5e-3)


SINE = Task("position", "sine", -1.0, 2.0, 0.5, 10.0, 1.0)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"control": "force"}, "force"),
        ({"wave": "sin"}, 'did you mean "sine"'),
        ({"low": -1.0001e6}, "low -1000100.0"),
        ({"high": 1.0001e6}, "high 1000100.0"),
        ({"low": 2.0}, "low 2.0"),
        ({"high": math.nan}, "high nan"),
        ({"frequency_rad_s": 0.0}, "frequency 0.0"),
        ({"frequency_rad_s": math.inf}, "frequency inf"),
        ({"skip_s": -1e-9}, "-1e-09 s"),
        ({"skip_s": 10.0}, "10.0 s"),
        ({"seconds": 100000.1}, "100000.1 s"),
        ({"seconds": 0.0, "skip_s": 0.0}, "0.0 s"),
    ],
)
def test_task_value_outside_its_range_is_rejected_by_name(change: Any, named: str) -> None:
    assert replace(SINE, low=-1e6, high=1e6, skip_s=0.0, seconds=1e5).seconds == 1e5
    with pytest.raises(InputError, match=named):
        replace(SINE, **change)
