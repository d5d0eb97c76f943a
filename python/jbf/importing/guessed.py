"""Results of the inspection of a file: proposed map entries and open questions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jbf.importing.formats.table import Table
from jbf.importing.mapping import Map


@dataclass(frozen=True)
class Question:
    """Information that the file does not contain and the user must provide.

    Attributes
    ----------
    place
        Column of the file, or key of the map, that the question concerns.
    asks
        Question in one line, with the required action.
    """

    place: str
    asks: str

    def __str__(self) -> str:
        return f"{self.place}: {self.asks}"


@dataclass(frozen=True)
class Entry:
    """Proposed line of a map: one column of a run.

    Attributes
    ----------
    key, expression
        Column of a run, and its expression, with `?` for open parts.
    why
        Evidence for the entry.
    sure
        Whether nothing about the entry is open.
    """

    key: str
    expression: str
    why: str
    sure: bool = True


@dataclass(frozen=True)
class Guess:
    """Map proposed for a file, with its open questions.

    Attributes
    ----------
    path
        The file.
    format
        Format of the file.
    tables
        Tables of the file.
    entries
        Lines of the map.
    ignored
        Columns of the file that are not used, and why.
    rig
        Sections of the rig; `?` for an open value.
    questions
        Questions that must be answered before the import.
    clocks
        Columns with a separate time column.
    beside
        Further files of the recording, with separate clocks.
    align, align_notes
        Alignment of these clocks, and its evidence.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> guess = jbf.look("sweep.csv")
    >>> guess.rig["drive"]["motion"], guess.questions
    ('linear', ())
    """

    path: Path
    format: str
    tables: tuple[Table, ...]
    entries: tuple[Entry, ...]
    ignored: Mapping[str, str] = field(default_factory=dict)
    rig: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    questions: tuple[Question, ...] = ()
    clocks: Mapping[str, str] = field(default_factory=dict)
    beside: tuple[Path, ...] = ()
    align: Mapping[str, str | float] = field(default_factory=dict)
    align_notes: Mapping[str, str] = field(default_factory=dict)

    @property
    def sure(self) -> bool:
        """Whether the file can be imported without further information."""
        return not self.questions

    def map(self) -> Map:
        """Convert the proposal to a `Map`."""
        columns = {entry.key: entry.expression for entry in self.entries}
        return Map(
            columns=columns,
            clocks=self.clocks,
            rig=self.rig,
            beside=self.beside,
            align=self.align,
        )
