"""What a look at a file gave: columns with how sure they are, and what must be asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jbf.importing.formats.table import Table
from jbf.importing.mapping import Map


@dataclass(frozen=True)
class Question:
    """Something that the file does not say.

    Attributes
    ----------
    place
        The column of the file, or the key of the map, that it is about.
    asks
        The question in a line, and what to do.
    """

    place: str
    asks: str

    def __str__(self) -> str:
        return f"{self.place}: {self.asks}"


@dataclass(frozen=True)
class Entry:
    """One line of the map.

    Attributes
    ----------
    key, expression
        Column of a run, and what it is made of; with `?` where something is open.
    why
        What it was known by.
    sure
        Nothing about it is open.
    """

    key: str
    expression: str
    why: str
    sure: bool = True


@dataclass(frozen=True)
class Guess:
    """A file's columns as far as they can be told.

    Attributes
    ----------
    path
        The file.
    format
        What it is.
    tables
        What is in it.
    entries
        Lines of the map.
    ignored
        Columns of the file that nothing is made of, and why.
    rig
        Sections of the rig; `?` where a value is open.
    questions
        What must be answered before it can be imported.
    clocks
        Columns with a time of their own.
    beside
        Further files of the recording, with separate clocks.
    align, align_notes
        How their clocks are aligned, and by what that is known.
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
        """Whether it can be imported as it is."""
        return not self.questions

    def map(self) -> Map:
        """The guess as a map."""
        columns = {entry.key: entry.expression for entry in self.entries}
        return Map(
            columns=columns,
            clocks=self.clocks,
            rig=self.rig,
            beside=self.beside,
            align=self.align,
        )
