"""Joints in robot logs: units implied by their names, and the choice of one joint."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.columns import parse_header
from jbf.importing.formats.table import Table

JOINT_UNITS: tuple[tuple[set[str], dict[str, str]], ...] = (
    (
        {"position", "velocity", "effort"},
        {"position": "rad", "velocity": "rad/s", "effort": "N m"},
    ),
    ({"q", "tau"}, {"q": "rad", "qd": "rad/s", "dq": "rad/s", "tau": "N m"}),
)
"""Units of joint quantities by the column names of robot software, for files without units."""


class JointNotChosen(InputError):
    """Error: a file holds several joints, and no valid one was named.

    Attributes
    ----------
    joints
        Labels of the joints.
    """

    def __init__(self, path: Path, joints: Sequence[str], named: str | None) -> None:
        self.joints = tuple(joints)
        contents = f"contains the joints {', '.join(joints)}"
        problem = contents if named is None else f"{contents}, but not {named}"
        remedy = f"choose one: --joint {joints[0]}, or --joint all with --folder"
        super().__init__(file=path, problem=problem, remedy=remedy)

    def __reduce__(self) -> tuple[object, ...]:
        return partial(InputError, **self._fields()), ()


def with_units_of_joint_states(table: Table) -> Table:
    """Add the units of `sensor_msgs/JointState` (revolute joints) to a table without units."""
    words = {c.name: set(re.findall("[a-z]+", c.name.lower())) for c in table.columns}
    all_words = {word for column_words in words.values() for word in column_words}
    units = next((units for needed, units in JOINT_UNITS if needed <= all_words), {})
    if not units or any(c.unit for c in table.columns if words[c.name] & units.keys()):
        return table
    columns = []
    for column in table.columns:
        matching = [unit for word, unit in units.items() if word in words[column.name]]
        is_unambiguous = len(matching) == 1 and not parse_header(column.name).unit
        columns.append(replace(column, unit=matching[0]) if is_unambiguous else column)
    return replace(table, columns=tuple(columns))
