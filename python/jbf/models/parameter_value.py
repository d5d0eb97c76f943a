"""The value of a parameter with its standard error."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from jbf.errors import InputError
from jbf.records.toml_file import number


@dataclass(frozen=True)
class ParameterValue:
    """Value of a parameter with its standard error.

    Attributes
    ----------
    value : float
        Value in the unit of the parameter's name; may be infinite but not nan.
    stderr : float or None
        Standard error in that unit; None if unknown (nan becomes None).
    note : str or None
        A remark, such as "at its lower bound".
    held : bool
        True if no fit determined the parameter. The value is used for predictions but is not an
        estimate, so it has no standard error. The note states the reason.

    Raises
    ------
    InputError
        A value is nan, an error is negative, or a held parameter has an error.

    Examples
    --------
    >>> p = jbf.ParameterValue(5.0, 0.1)
    >>> p.to_dict()
    {'value': 5.0, 'stderr': 0.1, 'note': None}
    """

    value: float
    stderr: float | None = None
    note: str | None = None
    held: bool = False

    def __post_init__(self) -> None:
        value = number(self.value, "value")
        if math.isnan(value):
            raise InputError(key="value", problem="nan is not a value", remedy="write a number")
        object.__setattr__(self, "value", value)
        if self.stderr is not None:
            stderr = number(self.stderr, "stderr")
            if stderr < 0.0:
                raise InputError(key="stderr", problem="is negative", remedy="remove the sign")
            object.__setattr__(self, "stderr", None if math.isnan(stderr) else stderr)
        if self.note is not None and not isinstance(self.note, str):
            raise InputError(key="note", problem="is not text", remedy="put it in quotation marks")
        if not isinstance(self.held, bool):
            raise InputError(key="held", problem="is not true or false", remedy="write held = true")
        if self.held and self.stderr is not None:
            problem = "is given with held = true, but a held parameter has no standard error"
            raise InputError(key="stderr", problem=problem, remedy="remove one of them")

    def to_dict(self) -> dict[str, Any]:
        """Return the parameter for JSON; a held parameter has no `stderr` entry."""
        if self.held:
            return {"value": self.value, "held": True, "note": self.note}
        return {"value": self.value, "stderr": self.stderr, "note": self.note}
