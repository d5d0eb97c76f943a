"""Reading TOML files, and checks of their values whose errors name the key."""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Iterable, Mapping
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from jbf.errors import InputError, did_you_mean, quoted
from jbf.text_files import read_text

PathLike = str | os.PathLike[str]


def number(value: object, key: str) -> float:
    """Convert a TOML number to float; infinity and nan are accepted.

    Raises
    ------
    InputError
        The value is not a number. Like all errors of the helpers in this module, it names `key` but
        no file.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        shown = quoted(value) if isinstance(value, str) else f"a {type(value).__name__}"
        raise InputError(key=key, problem=f"{shown} is not a number", remedy="write a plain number")
    try:
        return float(value)
    except OverflowError:
        raise InputError(key=key, problem="is too large", remedy="correct the value") from None


LEAST, MOST = 1e-12, 1e12
"""Limits of dimensions, masses, viscosities, loads and constants, in SI units.

Products and quotients of several values within these limits are finite.
"""


def positive(value: object, key: str) -> float:
    """Convert to a positive number of a plausible magnitude; raise as `number` does."""
    size = number(value, key)
    if not (0.0 < size < math.inf):
        raise InputError(
            key=key, problem=f"{size} is not above zero and finite", remedy="correct the value"
        )
    if not LEAST <= size <= MOST:
        raise InputError(key=key, problem=f"{size} is not plausible", remedy="give it in SI units")
    return size


def table(value: object, key: str) -> Mapping[str, Any]:
    """Return a TOML table as a mapping; raise an `InputError` if it is not a table."""
    if not isinstance(value, Mapping):
        raise InputError(key=key, problem="is not a table", remedy=f"write it as [{key}] with keys")
    return value


def refuse_unknown(keys: Iterable[str], valid: Iterable[str], prefix: str = "") -> None:
    """Raise for the first key of `keys` that is not in `valid`, and suggest the nearest known key.

    Raises
    ------
    InputError
        Names the key, preceded by `prefix`, but no file.
    """
    valid = list(valid)
    for key in keys:
        if key not in valid:
            raise InputError(
                key=prefix + str(key),
                problem="is not known",
                remedy=did_you_mean(str(key), valid),
            )


def require(keys: Iterable[str], required: Iterable[str], section: str) -> None:
    """Raise an `InputError` that names all required keys of a section that are missing."""
    present = set(keys)
    missing = [key for key in required if key not in present]
    if len(missing) == 1:
        remedy = f"add it to [{section}]"
        raise InputError(key=f"{section}.{missing[0]}", problem="is missing", remedy=remedy)
    if missing:
        names = f"{', '.join(missing[:-1])} and {missing[-1]}"
        remedy = f"add them to [{section}]"
        raise InputError(key=section, problem=f"lacks {names}", remedy=remedy)


def read_toml(path: PathLike) -> dict[str, Any]:
    """Return the content of a TOML file as plain Python values.

    Raises
    ------
    InputError
        The file cannot be read, or is not TOML; the error names the line.
    """
    text = read_text(path)
    try:
        return tomlkit.parse(text).unwrap()
    except (TOMLKitError, ValueError, RecursionError) as error:
        # tomlkit reports the end of the text as a null character, and appends its own line and
        # column.
        reason = (
            str(error).partition(" at line ")[0].replace("character: '\\x00'", "end").rstrip(".")
        )
        raise InputError(
            file=path,
            row=getattr(error, "line", None),
            problem=f"is not TOML ({reason[:1].lower()}{reason[1:]})",
            remedy="correct it; TOML is written key = value, each key once",
        ) from None
