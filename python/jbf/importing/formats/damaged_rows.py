"""Counter of damaged rows in a text file: a few are skipped, many raise an InputError."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from jbf.errors import InputError
from jbf.importing.formats.table import MAX_DAMAGED_SHARE

STOP_SHARE, STOP_ROWS = 1e-2, 20
"""Limits of damaged rows: reading stops above ``STOP_SHARE * rows + STOP_ROWS``."""


@dataclass
class DamagedRows:
    """Damaged rows of a text file that were skipped.

    Attributes
    ----------
    path
        The file.
    rows
        Number of rows that were read.
    lines
        Line numbers of the damaged rows.

    first
        Error of the first damaged row.
    """

    path: Path
    rows: int = 0
    lines: set[int] = field(default_factory=set)
    first: InputError | None = None

    def add(self, error: InputError) -> None:
        """Count a damaged row by its error; raise an InputError if there are too many."""
        assert error.row is not None
        self.lines.add(error.row)
        self.first = self.first or error
        if len(self.lines) > STOP_SHARE * self.rows + STOP_ROWS:
            raise self._refused()

    def check(self) -> None:
        """Raise an InputError if more than `MAX_DAMAGED_SHARE` of all rows are damaged."""
        if len(self.lines) > max(MAX_DAMAGED_SHARE * self.rows, 1.0):
            raise self._refused()

    def skipped_rows(self) -> list[tuple[int, str, int | None]]:
        """Number of damaged rows, the reason, and the first of them; empty without damaged rows."""
        if self.first is None:
            return []
        where = "" if self.first.column is None else f" in column {self.first.column}"
        why = f"the row is damaged ({self.first.problem}{where})"
        return [(len(self.lines), why, self.first.row)]

    def _refused(self) -> InputError:
        """Error for a file with too many damaged rows."""
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
