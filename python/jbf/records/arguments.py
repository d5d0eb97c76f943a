"""Type checks of the arguments of the public functions, with one-line errors.

This module checks types only. Functions that require certain contents of a run or a rig check
these contents themselves.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from numbers import Integral, Real
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from jbf.errors import InputError, did_you_mean, quoted
from jbf.records.checks import check_columns
from jbf.records.rig import Rig
from jbf.records.run import Run

Kind = TypeVar("Kind")
Word = TypeVar("Word", bound=str)


def described(value: object) -> str:
    """Describe a value for an error message: its type (`a list`), `None`, or a string in quotes."""
    if value is None:
        return "None"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, os.PathLike):
        return f"the path {quoted(os.fspath(value))}"
    name = type(value).__name__
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"


def of_kind(value: object, kind: type[Kind], what: str, remedy: str) -> Kind:
    """Return the value if it has the given type; otherwise raise an InputError about `what`."""
    if not isinstance(value, kind):
        raise InputError(problem=f"{what} is {described(value)}", remedy=remedy)
    return value


def the_rig(value: object) -> Rig:
    """Return the value if it is a rig; otherwise raise an InputError with a remedy."""
    remedy = "give a jbf.Rig, first of all (jbf.Rig() for a law in newtons)"
    if isinstance(value, str | os.PathLike):
        remedy = f"read it: jbf.read_rig({quoted(os.fspath(value))})"
    return of_kind(value, Rig, "the rig", remedy)


def one_run(value: object) -> Run:
    """Return the value if it is a run; otherwise raise an InputError with a remedy."""
    remedy = "give a jbf.Run"
    if isinstance(value, str | os.PathLike):
        remedy = f"read it: jbf.read_run({quoted(os.fspath(value))})"
    elif isinstance(value, list | tuple):
        remedy = "give one of them"
    return of_kind(value, Run, "the run", remedy)


def check_run(run: Run) -> None:
    """Raise an InputError if a run holds values that `Run.from_arrays` would have rejected.

    Such a run comes from the constructor, which does not check its arguments, or from a selection.
    """
    for column, values in ({"velocity_m_s": run.velocity} | run.columns()).items():
        valid = isinstance(values, np.ndarray) and values.dtype == np.float64 and values.ndim == 1
        if not valid or np.ma.is_masked(values):
            raise InputError(
                file=run.name,
                column=column,
                problem="is not an array of float64 of shape (N,)",
                remedy="make the run with jbf.Run.from_arrays, which converts and checks",
            )
    check_columns(run.name, run.columns(), None, None)


def list_of_runs(value: object) -> list[Run]:
    """Return runs as a list, after a check that every item is a run.

    Raises
    ------
    InputError
        The value is a single run, a path, a rig, or not an iterable of runs.
    """
    remedy = "give a list of jbf.Run"
    if isinstance(value, Run):
        raise InputError(problem="runs is a single run", remedy="write a list of one: [run]")
    if isinstance(value, str | os.PathLike):
        remedy = f"read them: jbf.read_runs({quoted(os.fspath(value))})"
    elif isinstance(value, Rig):
        remedy = "give the rig first, then the list of runs"
    if isinstance(value, str | Mapping) or not isinstance(value, Iterable):
        raise InputError(problem=f"runs is {described(value)}", remedy=remedy)
    runs = list(value)
    for i, run in enumerate(runs):
        if not isinstance(run, Run):
            remedy = "give a list of jbf.Run"
            if isinstance(run, str | os.PathLike):
                remedy = f"read it: jbf.read_run({quoted(os.fspath(run))})"
            raise InputError(problem=f"runs holds {described(run)} at index {i}", remedy=remedy)
        check_run(run)
    return runs


def names(value: object, what: str) -> tuple[str, ...]:
    """Return names as a tuple; a single string is rejected, because it is not a list of names.

    Parameters
    ----------
    what
        Name of the argument, for error messages.
    """
    if isinstance(value, str):
        raise InputError(
            problem=f"{what} is a string, but a list of names is required",
            remedy=f"write {what}=[{quoted(value) if value else ''}]",
        )
    if not isinstance(value, Iterable):
        raise InputError(
            problem=f"{what} is {described(value)}", remedy=f"write a list of names: {what}=[]"
        )
    entries = tuple(value)
    for name in entries:
        if not isinstance(name, str):
            raise InputError(
                problem=f"{what} holds {described(name)}", remedy="write names as strings"
            )
    return entries


def checked_integer(value: object, what: str, minimum: int = 0) -> int:
    """Return the value as an integer that is at least `minimum`; raise an InputError otherwise."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < minimum:
        shown = str(value) if isinstance(value, Real) else described(value)
        raise InputError(
            problem=f"{what} is {shown}", remedy=f"give an integer of at least {minimum}"
        )
    return int(value)


def check_callable(value: object, what: str) -> None:
    """Raise an InputError if the value is neither None nor callable."""
    if value is not None and not callable(value):
        raise InputError(problem=f"{what} is {described(value)}", remedy="give a function, or None")


def one_of(value: object, choices: Iterable[Word], what: str) -> Word:
    """Return the value if it is a known word; otherwise raise an InputError with a suggestion."""
    words = list(choices)
    for word in words:
        if isinstance(value, str) and value == word:
            return word
    if isinstance(value, str):
        raise InputError(
            problem=f"{what} {quoted(value)} is not known", remedy=did_you_mean(value, words)
        )
    raise InputError(
        problem=f"the {what} is {described(value)}", remedy=f"known: {', '.join(words)}"
    )


def by_name(value: object, what: str) -> dict[str, Any]:
    """Return a mapping with string keys as a new dict."""
    remedy = f'write them by name: {what}={{"NAME": VALUE}}'
    if not isinstance(value, Mapping):
        raise InputError(problem=f"{what} is {described(value)}", remedy=remedy)
    for name in value:
        if not isinstance(name, str):
            raise InputError(problem=f"{what} names {described(name)}", remedy=remedy)
    return dict(value)


def numbers(
    value: object, what: str, dtype: npt.DTypeLike = np.float64, *, flat: bool = False
) -> npt.NDArray[Any]:
    """Return a contiguous array of numbers; with `flat`, its shape must be (N,)."""

    def wrong(shown: str) -> InputError:
        return InputError(problem=f"{what} {shown}", remedy="give numbers, one per sample")

    if value is None:
        raise wrong("is None")
    try:
        array: npt.NDArray[Any] = np.ascontiguousarray(value, dtype=dtype)
    except (TypeError, ValueError):
        raise wrong("is not an array of numbers") from None
    if flat and array.ndim != 1:
        raise wrong(f"has shape {array.shape}")
    return array
