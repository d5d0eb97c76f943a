"""Common methods of results, and their only entry point to texts, tables and plots.

A result holds numbers and does not depend on their presentation. Each method here calls
`jbf.reporting.door`, which is imported at the first call. No other module below reporting may use
it.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from jbf.errors import InputError
from jbf.text_files import write_text

if TYPE_CHECKING:
    import os

    from matplotlib.axes import Axes


def _call_reporting(verb: str, result: object, *arguments: Any) -> Any:
    """Call a function of the reporting entry point."""
    return getattr(import_module("jbf.reporting.door"), verb)(result, *arguments)


class Shown:
    """Base of objects with a notebook representation."""

    def _repr_html_(self) -> str:
        table: str = _call_reporting("small_table", self)
        return table


class Result(Shown):
    """Methods that all results share."""

    def summary(self) -> str:
        """Return the result in words, as text for a terminal."""
        text: str = _call_reporting("summary", self)
        return text

    def plot(self, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
        """Plot the result on the given matplotlib axes, or on a new figure.

        No window opens; ``axes[0].figure.savefig("a.png")`` writes it.
        """
        drawn: Sequence[Axes] = _call_reporting("plot", self, axes)
        return drawn

    def to_dict(self) -> dict[str, Any]:
        """Return numbers and words for JSON; every result implements its own."""
        raise TypeError(f"{type(self).__name__} has no words for JSON")

    def to_frame(self) -> Any:
        """Return a `pandas.DataFrame`; pandas is not a dependency of jbf and must be installed.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        try:
            pandas = import_module("pandas")
        except ImportError:
            raise InputError(
                problem="a frame needs pandas, which is not installed", mend="pip install pandas"
            ) from None
        return pandas.DataFrame(_call_reporting("columns", self))

    def save_html(self, path: str | os.PathLike[str]) -> None:
        """Write a self-contained HTML page with plots, atomically.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, _call_reporting("page", self))

    def __repr__(self) -> str:
        line: str = _call_reporting("short_words", self)
        return line
