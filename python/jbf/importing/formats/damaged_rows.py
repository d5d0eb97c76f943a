"""Damaged rows among the samples of a text file, which are counted and skipped, or an error."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.formats.table import MAX_DAMAGED_SHARE

STOP_SHARE, STOP_ROWS = 1e-2, 20
"""Reading stops when the number of damaged rows exceeds STOP_SHARE * rows + STOP_ROWS."""


@dataclass
class DamagedRows:
    """Damaged rows of a file; a small number is skipped, a larger number is an error.

    Attributes
    ----------
    rows
        Number of rows that were read.
    lines
        Line numbers of the damaged rows.
    """

    path: Path
    rows: int = 0
    lines: set[int] = field(default_factory=set)
    first: InputError | None = None

    def add(self, error: InputError) -> None:
        """Count a damaged row; raise an error if there are too many."""
        assert error.row is not None
        self.lines.add(error.row)
        self.first = self.first or error
        if len(self.lines) > STOP_SHARE * self.rows + STOP_ROWS:
            raise self._refused()

    def check(self) -> None:
        """Raise an error if more than `MAX_DAMAGED_SHARE` of the rows are damaged."""
        if len(self.lines) > max(MAX_DAMAGED_SHARE * self.rows, 1.0):
            raise self._refused()

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Return the number of damaged rows, the reason and the first of them."""
        if self.first is None:
            return []
        where = "" if self.first.column is None else f" in column {self.first.column}"
        why = f"the row is damaged ({self.first.problem}{where})"
        return [(len(self.lines), why, self.first.row)]

    def _refused(self) -> InputError:
        assert self.first is not None
        extent = ""
        if len(self.lines) > 1:
            extent = f", and {len(self.lines)} of the first {self.rows} rows are damaged"
        return InputError(
            file=self.path,
            row=self.first.row,
            column=self.first.column,
            problem=self.first.problem + extent,
            remedy=self.first.remedy,
        )
