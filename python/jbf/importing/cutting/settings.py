"""Settings for cutting a recording: section `[cut]` of a map."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from jbf.arrays import Array
from jbf.errors import InputError, did_you_mean, quoted
from jbf.records.toml_file import number, refuse_unknown

RELATIONS: dict[str, Callable[[Array, float], Any]] = {
    "==": operator.eq,
    "!=": operator.ne,
    ">=": operator.ge,
    "<=": operator.le,
    ">": operator.gt,
    "<": operator.lt,
}
_COMPARISON = re.compile(r"((?:`[^`]*`|[^`<>=!])+)(==|!=|>=|<=|>|<)((?:`[^`]*`|[^`<>=!])+)")
METHODS = ("rests", "cycles", "set_point", "load_step", "motion", "run", "parts")
"""Cutting methods; each is implemented in a module of this package."""


@dataclass(frozen=True)
class Condition:
    """Condition on the rows of a file: comparison of two expressions over its columns.

    Attributes
    ----------
    difference
        Left side minus right side, as an expression.
    relation
        One of `RELATIONS`, between the difference and zero.
    text
        Original text.
    """

    difference: str
    relation: str
    text: str

    @classmethod
    def of(cls, text: object) -> Condition:
        """Parse a condition such as ``powered == 1``.

        Raises
        ------
        InputError
            If the text is not a comparison.
        """
        match = _COMPARISON.fullmatch(text) if isinstance(text, str) else None
        if match is None:
            remedy = 'write a comparison, such as "powered == 1" or "load > 5 [N]"'
            raise InputError(key="cut.keep", problem=f"{text!r} is not a condition", remedy=remedy)
        quantity, relation, limit = (part.strip() for part in match.groups())
        difference = quantity if limit == "0" else f"{quantity} - ({limit})"
        return cls(difference, relation, str(text))

    def holds(self, values: Array) -> Array:
        """Return 1 where values of `difference` fulfil the condition, 0 elsewhere, NaN for NaN."""
        satisfied = RELATIONS[self.relation](np.asarray(values, dtype=np.float64), 0.0)
        return np.where(np.isfinite(values), satisfied, np.nan)


@dataclass(frozen=True)
class CutSettings:
    """Settings that determine how a recording is cut into runs.

    Attributes
    ----------
    by
        Methods of `METHODS`, all of which are applied. Empty: one run per recording (and per
        restart of time). None: at rests, if that yields runs (`cut.at_rests_by_default`).
    column
        Column of the file (an expression) for `set_point` or `run`.
    rest_s
        Duration from which a rest causes a cut, s.
    keep_rest_s
        Part of a rest that remains with the motion before and after it, s.
    shortest_s
        Duration below which pieces are left out, s.
    still
        Share of the top speed below which a motion is at rest. If None, the noise of the record
        is also considered.
    parts
        Number of parts of equal duration for the method `parts`; 2 for halves.
    keep
        Condition for the rows that are kept, such as ``powered == 1``; others are left out.
    file
        File of edited trims, which replaces all methods.
    """

    by: tuple[str, ...] | None = None
    column: str | None = None
    rest_s: float = 2.0
    keep_rest_s: float = 0.5
    shortest_s: float = 0.0
    still: float | None = None
    parts: int = 10
    keep: Condition | None = None
    file: Path | None = None

    @classmethod
    def from_mapping(cls, section: Mapping[str, Any], folder: Path) -> CutSettings:
        """Create settings from the section `[cut]`; paths are relative to the folder of the map.

        Raises
        ------
        InputError
            If a key is unknown or its value is invalid. The error names no file.
        """
        refuse_unknown(section, [f.name for f in fields(cls)], "cut.")
        given = dict(section)
        by = given.pop("by", None)
        if by is None:
            # A setting for the duration or speed of rests implies cutting at rests.
            methods = ("rests",) if {"rest_s", "keep_rest_s", "still"} & given.keys() else None
            methods = ("parts",) if "parts" in given else methods
        elif not isinstance(by, str | list | tuple):
            remedy = 'write by = "rests", or a list of methods'
            raise InputError(key="cut.by", problem=f"{by!r} is not a cutting method", remedy=remedy)
        else:
            methods = (by,) if isinstance(by, str) else tuple(by)
        for method in methods or ():
            if method not in METHODS:
                raise InputError(
                    key="cut.by",
                    problem=f"{quoted(method)} is not a cutting method",
                    remedy=did_you_mean(method, METHODS),
                )
        needs = [method for method in methods or () if method in ("set_point", "run")]
        if needs and not isinstance(given.get("column"), str):
            raise InputError(
                key="cut.column",
                problem="is missing",
                remedy=f'by = "{needs[0]}" requires a column, such as "setpoint_rpm"',
            )
        for key in ("rest_s", "keep_rest_s", "shortest_s", "still"):
            if key in given:
                given[key] = number(given[key], f"cut.{key}")
                if not 0.0 <= given[key] < math.inf:
                    problem = f"{given[key]} is negative or not finite"
                    raise InputError(key=f"cut.{key}", problem=problem, remedy="correct it")
        if "parts" in given and "parts" not in (methods or ()):
            remedy = 'add "parts" to by, or remove it'
            raise InputError(key="cut.parts", problem='is used by by = "parts" only', remedy=remedy)
        parts = given.get("parts", 2)
        if isinstance(parts, bool) or not isinstance(parts, int) or parts < 2:
            problem = f"{parts!r} is not an integer of at least 2"
            raise InputError(key="cut.parts", problem=problem, remedy="write parts = 2 for halves")
        if "keep" in given:
            given["keep"] = Condition.of(given["keep"])
        if "file" in given:
            if not isinstance(given["file"], str):
                remedy = 'write file = "cut.toml"'
                raise InputError(key="cut.file", problem="is not text", remedy=remedy)
            given["file"] = folder / given["file"]
        return cls(**(given | {"by": methods}))
