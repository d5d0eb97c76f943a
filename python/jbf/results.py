"""Common methods of results, and the registry of the functions that present them.

The class of a result contains numerical data and does not depend on presentation code. Presenters
are registered by operation and type with `register`. A module that registers them is named by
`presented_by` and imported at the first call, because texts and plots take long to import.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from jbf.errors import InputError
from jbf.text_files import write_text

if TYPE_CHECKING:
    import os

    import numpy as np
    import numpy.typing as npt
    from matplotlib.axes import Axes

    AxesOrArray = Axes | Sequence[Axes] | npt.NDArray[np.object_]

Operation = Literal["summary", "short_words", "small_table", "columns", "plot", "page"]
"""Presentation of a result.

`summary` is a text for a terminal, `short_words` one or two lines, `small_table` an HTML table,
`columns` arrays of equal length by name, `plot` matplotlib axes, and `page` an HTML page.
"""
Kind = TypeVar("Kind")

_presenters: dict[Operation, dict[type, Callable[..., Any]]] = {}
_modules: dict[Operation, list[str]] = {}


def register(operation: Operation, kind: type[Kind], presenter: Callable[..., Any]) -> None:
    """Register the function that presents results of a type, and of types derived from it."""
    _presenters.setdefault(operation, {})[kind] = presenter


def presented_by(module: str, *operations: Operation) -> None:
    """Name a module that registers presenters; it is imported when one of them is needed."""
    for operation in operations:
        _modules.setdefault(operation, []).append(module)


def present(operation: Operation, result: object, *arguments: Any) -> Any:
    """Call the function that is registered to present a result.

    Raises
    ------
    TypeError
        No presenter is registered for the type of the result.
    """
    for module in _modules.get(operation, ()):
        import_module(module)
    presenters = _presenters.get(operation, {})
    for kind in type(result).__mro__:
        if kind in presenters:
            return presenters[kind](result, *arguments)
    raise TypeError(f"no {operation} is registered for results of type {type(result).__name__}")


def data_frame(columns: Any) -> Any:
    """Convert columns to a `pandas.DataFrame`; pandas is an optional dependency.

    Raises
    ------
    InputError
        pandas is not installed.
    """
    return optional("pandas", "a frame").DataFrame(columns)


def optional(module: str, what: str) -> Any:
    """Import a package that is not a dependency of jbf.

    Raises
    ------
    InputError
        The package is not installed.
    """
    try:
        return import_module(module)
    except ImportError:
        raise InputError(
            problem=f"{what} needs {module}, which is not installed", remedy=f"pip install {module}"
        ) from None


class Shown:
    """Base class of objects with an HTML representation in notebooks."""

    def _repr_html_(self) -> str:
        table: str = present("small_table", self)
        return table


class Result(Shown):
    """Base class of results, with the methods common to all of them."""

    def summary(self) -> str:
        """Return a summary of the result as plain text for a terminal."""
        text: str = present("summary", self)
        return text

    def plot(self, axes: AxesOrArray | None = None) -> Axes | npt.NDArray[np.object_]:
        """Plot the result on the given matplotlib axes, or on a new figure.

        Parameters
        ----------
        axes
            Axes to draw on; their number must be that of the returned axes. Default: those of a new
            figure.

        Returns
        -------
        matplotlib.axes.Axes or ndarray of Axes
            A single axes, or an array of shape (n,). No window opens;
            ``jbf.plot.save(result.plot(), "a.png")`` writes the figure.

        Raises
        ------
        InputError
            The number of axes is wrong, or the result has nothing to plot.
        """
        import numpy as np  # a large part of the import time of jbf

        axes_drawn = np.ravel(np.asarray(present("plot", self, axes), dtype=object))
        single: Axes = axes_drawn[0]
        return axes_drawn if len(axes_drawn) > 1 else single

    def to_dict(self) -> dict[str, Any]:
        """Return the result as JSON-serializable data; implemented by each subclass."""
        raise TypeError(f"{type(self).__name__} cannot be converted to JSON")

    def to_frame(self) -> Any:
        """Return the result as a `pandas.DataFrame`; pandas is an optional dependency.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        return data_frame(present("columns", self))

    def save_html(self, path: str | os.PathLike[str]) -> None:
        """Write a self-contained HTML page with plots, atomically.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, present("page", self))

    def __repr__(self) -> str:
        line: str = present("short_words", self)
        return line
