"""What people pass to the public functions: the right kind of thing, or one clear line.

Checks of kinds only; what a record or a rig must hold for some purpose is asked where it is used.
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
Array = npt.NDArray[np.float64]


def described(value: object) -> str:
    """A value as an error calls it: `a list`, `None`, the text itself."""
    if value is None:
        return "None"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, os.PathLike):
        return f"the path {quoted(os.fspath(value))}"
    name = type(value).__name__
    return f"{'an' if name[0] in 'AEIOUaeiou' else 'a'} {name}"


def of_kind(value: object, kind: type[Kind], what: str, mend: str) -> Kind:
    """The value, where it is of that kind; an InputError calls it `what`."""
    if not isinstance(value, kind):
        raise InputError(problem=f"{what} is {described(value)}", mend=mend)
    return value


def the_rig(value: object) -> Rig:
    """A rig; an InputError says how to come by one."""
    mend = "give a jbf.Rig, first of all (jbf.Rig() for a law in newtons)"
    if isinstance(value, str | os.PathLike):
        mend = f"read it: jbf.read_rig({quoted(os.fspath(value))})"
    return of_kind(value, Rig, "the rig", mend)


def one_run(value: object) -> Run:
    """A run; an InputError says how to come by one."""
    mend = "give a jbf.Run"
    if isinstance(value, str | os.PathLike):
        mend = f"read it: jbf.read_run({quoted(os.fspath(value))})"
    elif isinstance(value, list | tuple):
        mend = "give one of them"
    return of_kind(value, Run, "the run", mend)


def check_run(run: Run) -> None:
    """An InputError where a run holds what `Run.from_arrays` would have refused: a constructor that
    trusts its arguments, or a selection, made it."""
    for column, values in ({"velocity_m_s": run.velocity_m_s} | run.columns()).items():
        good = isinstance(values, np.ndarray) and values.dtype == np.float64 and values.ndim == 1
        if not good or np.ma.is_masked(values):
            raise InputError(
                file=run.name,
                column=column,
                problem="is no array of float64, shape (N,)",
                mend="make the run with jbf.Run.from_arrays, which converts and checks",
            )
    check_columns(run.name, run.columns(), None, None)


def list_of_runs(value: object) -> list[Run]:
    """Runs as a list, none of them anything else.

    Raises
    ------
    InputError
        One run that stands alone, a path, a rig, or nothing of the kind.
    """
    mend = "give a list of jbf.Run"
    if isinstance(value, Run):
        raise InputError(problem="runs is a single run", mend="write a list of one: [run]")
    if isinstance(value, str | os.PathLike):
        mend = f"read them: jbf.read_runs({quoted(os.fspath(value))})"
    elif isinstance(value, Rig):
        mend = "give the rig first, then the list of runs"
    if isinstance(value, str | Mapping) or not isinstance(value, Iterable):
        raise InputError(problem=f"runs is {described(value)}", mend=mend)
    runs = list(value)
    for i, run in enumerate(runs):
        if not isinstance(run, Run):
            mend = "give a list of jbf.Run"
            if isinstance(run, str | os.PathLike):
                mend = f"read it: jbf.read_run({quoted(os.fspath(run))})"
            raise InputError(problem=f"runs holds {described(run)} at place {i}", mend=mend)
        check_run(run)
    return runs


def names(value: object, what: str) -> tuple[str, ...]:
    """Names as a tuple; a word that stands alone is no list of names.

    Parameters
    ----------
    what
        The argument's name.
    """
    if isinstance(value, str):
        raise InputError(
            problem=f"{what} is text where a list of names is meant",
            mend=f"write {what}=[{quoted(value) if value else ''}]",
        )
    if not isinstance(value, Iterable):
        raise InputError(
            problem=f"{what} is {described(value)}", mend=f"write a list of names: {what}=[]"
        )
    found = tuple(value)
    for name in found:
        if not isinstance(name, str):
            raise InputError(
                problem=f"{what} holds {described(name)}", mend="write names, in quotes"
            )
    return found


def whole_number(value: object, what: str, least: int = 0) -> int:
    """A whole number, not below `least`."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < least:
        shown = str(value) if isinstance(value, Real) else described(value)
        raise InputError(problem=f"{what} is {shown}", mend=f"give a whole number from {least} on")
    return int(value)


def check_callable(value: object, what: str) -> None:
    """An InputError where this is neither None nor a function."""
    if value is not None and not callable(value):
        raise InputError(problem=f"{what} is {described(value)}", mend="give a function, or None")


def one_of(value: object, known: Iterable[Word], what: str) -> Word:
    """One of the known words; an InputError names the nearest."""
    words = list(known)
    for word in words:
        if isinstance(value, str) and value == word:
            return word
    if isinstance(value, str):
        raise InputError(
            problem=f"there is no {what} {quoted(value)}", mend=did_you_mean(value, words)
        )
    raise InputError(problem=f"the {what} is {described(value)}", mend=f"known: {', '.join(words)}")


def by_name(value: object, what: str) -> dict[str, Any]:
    """Values by name as a dict of its own."""
    mend = f'write them by name: {what}={{"NAME": VALUE}}'
    if not isinstance(value, Mapping):
        raise InputError(problem=f"{what} is {described(value)}", mend=mend)
    for name in value:
        if not isinstance(name, str):
            raise InputError(problem=f"{what} names {described(name)}", mend=mend)
    return dict(value)


def numbers(
    value: object, what: str, dtype: npt.DTypeLike = np.float64, *, flat: bool = False
) -> npt.NDArray[Any]:
    """An array of numbers, contiguous; `flat` where it must have the shape (N,)."""

    def wrong(shown: str) -> InputError:
        return InputError(problem=f"{what} {shown}", mend="give numbers, one a sample")

    if value is None:
        raise wrong("is None")
    try:
        array: npt.NDArray[Any] = np.ascontiguousarray(value, dtype=dtype)
    except (TypeError, ValueError):
        raise wrong("is no array of numbers") from None
    if flat and array.ndim != 1:
        raise wrong(f"has shape {array.shape}")
    return array
