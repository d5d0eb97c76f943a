"""Consistency of position, speed and time in their units, with questions if they disagree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from jbf.errors import InputError
from jbf.importing.evaluation import converted, evaluate
from jbf.importing.expression import parse_expression
from jbf.importing.formats.table import Table, Values
from jbf.importing.guessed import Entry, Question
from jbf.importing.names import column_names, column_units
from jbf.importing.targets import wanted_unit

_MIN_CORRELATION = 0.9
"""Minimum correlation of speed and change of position for a meaningful ratio."""
MAX_RATIO = 1.25
"""Factor by which a ratio may exceed or fall below 1 without indicating a wrong unit."""
PAIRS = (
    ("position_m", "velocity_m_s"),
    ("angle_rad", "velocity_rad_s"),
    ("angle_rad", "speed_rpm"),
    ("motor_angle_rad", "motor_speed_rpm"),
)
"""Pairs of a position and its speed."""
_MIN_SAMPLES = 20


def contradictions(
    by_key: Mapping[str, Entry], tables: Sequence[Table], heads: Mapping[str, Values]
) -> list[Question]:
    """Questions for each speed that is not the rate of change of its position."""
    questions = []
    for place, speed in PAIRS:
        if not {place, speed, "time_s"} <= by_key.keys():
            continue
        if not all(by_key[key].sure for key in (place, speed, "time_s")):
            continue
        ratio = speed_ratio(by_key, (place, speed), tables, heads)
        if ratio is not None and not 1.0 / MAX_RATIO < ratio < MAX_RATIO:
            statement = f"{by_key[speed].expression} is {ratio:.4g} times the derivative of"
            question = (
                f"{statement} {by_key[place].expression}: one unit, or that of the time, is wrong"
            )
            questions.append(Question(speed, f"{question}; write the right unit after the column"))
    return questions


def speed_ratio(
    entries: Mapping[str, Entry],
    pair: tuple[str, str],
    tables: Sequence[Table],
    heads: Mapping[str, Values],
) -> float | None:
    """Ratio of a speed to the rate of change of its position; None if they are not correlated."""
    names, units = column_names(tables), column_units(tables)
    values = []
    try:
        for key in ("time_s", *pair):
            node = parse_expression(entries[key].expression, names)
            unit = wanted_unit(key)
            values.append(converted(evaluate(node, heads, units), unit, key) * unit.in_si)
    except InputError:
        return None
    if len({len(column) for column in values}) != 1 or len(values[0]) < _MIN_SAMPLES:
        return None
    finite = np.all(np.isfinite(values), axis=0)
    time, place, speed = (column[finite] for column in values)
    steps = np.diff(time)
    if len(time) < _MIN_SAMPLES or not (steps > 0.0).any():
        return None
    moves = steps > 0.0
    change = np.diff(place)[moves] / steps[moves]
    mean = (0.5 * (speed[1:] + speed[:-1]))[moves]
    power = float(change @ change) * float(mean @ mean)
    if power == 0.0 or abs(float(change @ mean)) < _MIN_CORRELATION * power**0.5:
        return None
    return abs(float(change @ mean)) / float(change @ change)
