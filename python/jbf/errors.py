"""Exceptions and warnings of the package, with messages for users.

A message about invalid input is one line that names the file, the location and the remedy.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from difflib import get_close_matches
from functools import partial
from typing import Any

_LONGEST_QUOTE = 40
_CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


class JbfError(Exception):
    """Base class of all exceptions defined by jbf.

    Examples
    --------
    >>> try:
    ...     jbf.read_rig("missing.toml")
    ... except jbf.JbfError as error:
    ...     print(type(error).__name__)
    InputError
    """


class FilmWarning(UserWarning):
    """Warning that a lubricant film is too fast to integrate; see :meth:`jbf.Model.predict`.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", jbf.FilmWarning)   # a prediction then raises it
    """


class Stopped(KeyboardInterrupt):
    """Exception for a fit or a diagnosis that was interrupted (Ctrl-C).

    Attributes
    ----------
    fit
        The best :class:`jbf.Fit` so far.

    Examples
    --------
    >>> try:
    ...     raise jbf.Stopped(None)   # as jbf.fit does at Ctrl-C, with its best fit so far
    ... except jbf.Stopped as stop:
    ...     print(stop.fit)
    None
    """

    def __init__(self, fit: Any) -> None:
        super().__init__("interrupted; its .fit is the best so far")
        self.fit = fit


class InputError(JbfError, ValueError):
    """Exception for invalid input; ``str(error)`` is one line.

    Parameters
    ----------
    problem : str
        The problem, as a clause that follows the place: ``"abc" is not a number``.
    remedy : str, optional
        The remedy, in the imperative.
    file : path, optional
        The file, or the name of the object if there is no file.
    row : int, optional
        Line number in the file; the header is line 1.
    column, key : str, optional
        The CSV column, or the dotted TOML key.

    Examples
    --------
    >>> problem, remedy = '"abc" is not a number', "correct the cell"
    >>> place = {"file": "a.csv", "row": 17, "column": "friction_n"}
    >>> print(jbf.InputError(**place, problem=problem, remedy=remedy))
    a.csv, row 17, column friction_n: "abc" is not a number; correct the cell
    """

    def __init__(
        self,
        *,
        problem: str,
        remedy: str | None = None,
        file: str | os.PathLike[str] | None = None,
        row: int | None = None,
        column: str | None = None,
        key: str | None = None,
    ) -> None:
        self.file = None if file is None else os.fspath(file)
        self.row = row
        self.column = column
        self.key = key
        self.problem = problem
        self.remedy = remedy
        super().__init__(str(self))

    def __str__(self) -> str:
        place = [
            self.file,
            None if self.row is None else f"row {self.row}",
            None if self.column is None else f"column {self.column}",
            None if self.key is None else f"key {self.key}",
        ]
        head = ", ".join(part for part in place if part is not None)
        line = f"{head}: {self.problem}" if head else self.problem
        if self.remedy:
            line = f"{line}; {self.remedy}"
        # A file name or a quoted cell may contain a line break, but the message must be one line.
        return printable(" ".join(line.split()))

    def within(
        self, *, file: str | os.PathLike[str] | None = None, key_prefix: str = ""
    ) -> InputError:
        """Return a copy of the error with a more precise location.

        Parameters
        ----------
        file : path, optional
            Used if this error names no file yet.
        key_prefix : str
            Prefix of the key, for example ``"bearing."``.
        """
        fields = self._fields()
        fields["file"] = self.file if self.file is not None else file
        fields["key"] = key_prefix + self.key if self.key is not None else None
        return InputError(**fields)

    def _fields(self) -> dict[str, Any]:
        names = ("problem", "remedy", "file", "row", "column", "key")
        return {name: getattr(self, name) for name in names}

    def __reduce__(self) -> tuple[Any, ...]:
        # By default, pickle would call the class with a positional argument, so an error raised in
        # a worker process could not be returned.
        return partial(type(self), **self._fields()), ()


class Unfinished(InputError):
    """Exception for a fit or a diagnosis that was aborted because it would take too long.

    Parameters
    ----------
    steps
        Number of integration steps of the model.
    fit
        The best :class:`jbf.Fit` so far, or None.
    time_limit_s
        The time limit that was reached, s; None if the computing budget was exceeded.
    share
        Fraction of the time limit that was available for this part of the computation.
    sufficient_s
        Time limit that would probably suffice, s; None if unknown.

    Examples
    --------
    >>> issubclass(jbf.Unfinished, jbf.InputError)
    True
    """

    def __init__(
        self,
        *,
        steps: float,
        fit: Any = None,
        file: str | None = None,
        time_limit_s: float | None = None,
        share: float = 1.0,
        sufficient_s: float | None = None,
    ) -> None:
        self.steps, self.fit = steps, fit
        self.time_limit_s, self.share, self.sufficient_s = time_limit_s, share, sufficient_s
        best = "no fit so far"
        if fit is not None:
            model = " + ".join([fit.model.law, *fit.model.effects])
            unit = fit.model.rig.quantities.force
            best = f"the best so far is {model}, RMS {fit.rms:.3g} {unit}, not finished"
        if time_limit_s is None:
            done = f"not finished after {steps:.1g} steps of the model"
            remedy = (
                "check the unit of time, or use a law without memory, such as stribeck, or a "
                "higher sampling rate"
            )
        else:
            done = f"not finished within the time limit of {time_limit_s:g} s"
            remedy = "use a longer time limit"
            if sufficient_s is not None:
                remedy = f"use a longer time limit; {sufficient_s:g} s would probably suffice"
        super().__init__(problem=f"{done}; {best}", remedy=remedy, file=file)

    @property
    def reason(self) -> str:
        """Reason why a part of a computation was omitted, as a clause."""
        if self.time_limit_s is None:
            return "computing time limit reached"
        share = "its share of the " if self.share < 1.0 else ""
        return f"{share}time limit of {self.time_limit_s:g} s reached"

    def with_fit(
        self, fit: Any, file: str | None = None, sufficient_s: float | None = None
    ) -> Unfinished:
        """Return a copy of the error with the best fit so far."""
        changed = {"fit": fit, "file": file, "sufficient_s": sufficient_s}
        return Unfinished(**{**self._arguments(), **changed})

    def _arguments(self) -> dict[str, Any]:
        names = ("steps", "fit", "file", "time_limit_s", "share", "sufficient_s")
        return {name: getattr(self, name) for name in names}

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(type(self), **self._arguments()), ()


def printable(text: str) -> str:
    """Escape control characters, which a terminal would otherwise interpret."""
    return _CONTROLS.sub(lambda match: f"\\x{ord(match[0]):02x}", text)


def quoted(text: object) -> str:
    """Return external text in double quotes, with control characters escaped, truncated if long."""
    escaped = str(text)
    if not escaped.isprintable():
        escaped = escaped.encode("unicode_escape").decode("ascii")
    if len(escaped) > _LONGEST_QUOTE:
        escaped = escaped[: _LONGEST_QUOTE - 3] + "..."
    return f'"{escaped}"'


def closest(word: str, words: Iterable[str], cutoff: float = 0.6) -> str | None:
    """Known word that is most similar to `word`, ignoring case; None if none is similar."""
    by_lower = {name.lower(): name for name in words}
    matches = get_close_matches(word.lower(), list(by_lower), n=1, cutoff=cutoff)
    return by_lower[matches[0]] if matches else None


def did_you_mean(word: object, words: Iterable[str]) -> str:
    """Remedy for an unknown word: the most similar known word, or the list of all known words."""
    names = list(words)
    guess = closest(word, names) if isinstance(word, str) else None
    if guess is not None:
        return f"did you mean {quoted(guess)}?"
    return f"known: {', '.join(names)}" if names else "remove it"
