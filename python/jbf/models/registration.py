"""Checks of a user-defined effect or law when it is registered."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Container, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

import numpy as np

from jbf.errors import InputError, quoted
from jbf.models.catalogue import Parameter


class Texts(TypedDict):
    """Texts of a catalogue entry."""

    summary: str
    equation: str
    source: str
    limits: str


@dataclass(frozen=True)
class Registration:
    """User-defined function to be registered as an effect or a law.

    Attributes
    ----------
    kind
        `effect` or `law`, for messages.
    name
        Name of the entry.
    function
        The function.
    parameters
        Its parameters.
    """

    kind: Literal["effect", "law"]
    name: str
    function: Callable[..., Any]
    parameters: tuple[Parameter, ...]

    @classmethod
    def of(
        cls,
        kind: Literal["effect", "law"],
        function: Callable[..., Any],
        name: str | None,
        parameters: Sequence[Parameter],
    ) -> Registration:
        """Create a registration; the default name is that of the function."""
        return cls(kind, function.__name__ if name is None else name, function, tuple(parameters))

    def refused(self, problem: str, remedy: str) -> InputError:
        """Error for this user-defined law or effect, with a problem and a remedy."""
        return InputError(problem=f"the {self.kind} {quoted(self.name)} {problem}", remedy=remedy)

    def check_name(self, built_in: Container[str], reserved: str | None = None) -> None:
        """Raise an InputError if the name is invalid, reserved, or that of a built-in entry."""
        if not self.name.isidentifier() or self.name == reserved:
            excluded = "" if reserved is None else f", not {reserved}"
            raise self.refused(
                "has an invalid name", f"use letters, digits and _{excluded}: name=..."
            )
        if self.name in built_in:
            raise self.refused("is in the catalogue already", "choose another name")

    def check_parameters(self) -> None:
        """Raise an InputError if a parameter lacks a valid name, bounds or start."""
        names = [p.name for p in self.parameters]
        if len(set(names)) < len(names):
            raise self.refused("has two parameters of the same name", "rename one")
        for p in self.parameters:
            fault = _fault(p)
            if fault is not None:
                problem, mend = fault
                raise self.refused(f"has a parameter {quoted(p.name)} {problem}", mend)

    def columns(self) -> tuple[str, ...]:
        """Arguments of the function that are columns of a run.

        Raises
        ------
        InputError
            A parameter is not an argument of the function, or an argument has no name.
        """
        kinds = inspect.Parameter
        names = {p.name for p in self.parameters}
        columns = []
        for argument in inspect.signature(self.function).parameters.values():
            if argument.kind not in (kinds.POSITIONAL_OR_KEYWORD, kinds.KEYWORD_ONLY):
                raise self.refused(
                    f"takes {argument}", "name every column and parameter explicitly"
                )
            if argument.name in names:
                names.remove(argument.name)
            else:
                columns.append(argument.name)
        if names:
            missing = ", ".join(sorted(names))
            raise self.refused(
                f"does not take its parameter {missing}", "add it to the function's arguments"
            )
        return tuple(columns)

    def texts(self, summary: str, equation: str, source: str, limits: str) -> Texts:
        """Texts of the catalogue entry, with defaults for empty ones."""
        first = (inspect.getdoc(self.function) or f"a user-defined {self.kind}").splitlines()[0]
        return Texts(
            summary=summary or first,
            equation=equation or "a user-defined function",
            source=source or f"{getattr(self.function, '__module__', 'unknown')}",
            limits=limits or "not specified",
        )


def _fault(p: Parameter) -> tuple[str, str] | None:
    """First problem of a parameter's definition, and its remedy; None if there is none."""
    if not p.name.isidentifier():
        return "that is not a valid name", "use letters, digits and _"
    if not (np.isfinite(p.lower) and np.isfinite(p.upper) and p.lower < p.upper):
        return "without bounds", "give lower and upper, finite and in order"
    if not p.starts:
        return "without a starting value", "give starts=(value,)"
    if not all(p.lower <= s <= p.upper for s in p.starts):
        return "that starts outside its bounds", "choose a start within the bounds"
    if p.log and p.lower <= 0.0:
        return "whose logarithm does not exist", "set lower above 0, or log=False"
    if p.null is not None and not p.lower <= p.null <= p.upper:
        return "with its null outside its bounds", "extend the bounds to the null"
    return None
