"""What every result can do, and the one door from results to their words, tables and pictures.

A result knows its numbers and nothing of pages: each verb here asks `jbf.reporting.door`, which is
imported at the first call. Nothing else below reporting may ask it for anything.
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


def _asked(verb: str, result: object, *arguments: Any) -> Any:
    """What the door answers."""
    return getattr(import_module("jbf.reporting.door"), verb)(result, *arguments)


class Shown:
    """What shows itself in a notebook."""

    def _repr_html_(self) -> str:
        table: str = _asked("small_table", self)
        return table


class Result(Shown):
    """The verbs that results share."""

    def summary(self) -> str:
        """The result in words, as text for a terminal."""
        text: str = _asked("summary", self)
        return text

    def plot(self, axes: Sequence[Axes] | None = None) -> Sequence[Axes]:
        """A picture on matplotlib axes: those given, or a new figure's.

        No window opens; ``axes[0].figure.savefig("a.png")`` writes it.
        """
        drawn: Sequence[Axes] = _asked("plot", self, axes)
        return drawn

    def to_dict(self) -> dict[str, Any]:
        """Numbers and words, for JSON; every result says its own."""
        raise TypeError(f"{type(self).__name__} has no words for JSON")

    def to_frame(self) -> Any:
        """A `pandas.DataFrame`; pandas comes with no jbf and must be installed.

        Raises
        ------
        InputError
            There is no pandas.
        """
        try:
            pandas = import_module("pandas")
        except ImportError:
            raise InputError(
                problem="a frame needs pandas, which is not installed", mend="pip install pandas"
            ) from None
        return pandas.DataFrame(_asked("columns", self))

    def save_html(self, path: str | os.PathLike[str]) -> None:
        """Write a self-contained HTML page with pictures, whole or not at all.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, _asked("page", self))

    def __repr__(self) -> str:
        line: str = _asked("short_words", self)
        return line
