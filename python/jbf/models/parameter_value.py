"""A parameter's value with its error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from jbf.errors import InputError
from jbf.records.toml_file import number


@dataclass(frozen=True)
class ParameterValue:
    """One parameter.

    `value` is in the unit that the parameter's name tells, and may be infinite but not nan;
    `stderr` is one standard error in that unit, None when not known (nan becomes None); `note` is
    a remark, such as "at its lower bound".
    """

    value: float
    stderr: float | None = None
    note: str | None = None

    def __post_init__(self) -> None:
        value = number(self.value, "value")
        if math.isnan(value):
            raise InputError(key="value", problem="nan is not a value", mend="write a number")
        object.__setattr__(self, "value", value)
        if self.stderr is not None:
            stderr = number(self.stderr, "stderr")
            if stderr < 0.0:
                raise InputError(key="stderr", problem="is negative", mend="drop the sign")
            object.__setattr__(self, "stderr", None if math.isnan(stderr) else stderr)
        if self.note is not None and not isinstance(self.note, str):
            raise InputError(key="note", problem="is not text", mend="put it in quotes")

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"value": self.value, "stderr": self.stderr, "note": self.note}
