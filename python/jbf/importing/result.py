"""What an import gave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from jbf.importing.cutting.piece import Piece
from jbf.importing.overview import Overview
from jbf.records.rig import Rig
from jbf.records.run import Run
from jbf.records.run_files import read_runs
from jbf.results import Result


@dataclass(frozen=True, eq=False, repr=False)
class Import(Result):
    """Runs and a rig, made of recordings.

    Attributes
    ----------
    folder : Path
        Where they are: the runs as CSV, `rig.toml`, `map.toml`, `cut.toml`, `import.json`.
    rig : Rig
        What they were recorded on.
    pieces : tuple of Piece
        How the recordings were cut, what is left out among it.
    ledger : dict
        What `import.json` holds: file, channel, unit as read and made, clock, rows dropped and why.
    overviews : tuple of Overview
        Each recording in few points, for a picture.
    """

    folder: Path
    rig: Rig
    pieces: tuple[Piece, ...]
    ledger: Mapping[str, Any]
    overviews: tuple[Overview, ...] = ()
    # Kept for as long as the result is: where nobody named a folder.
    _temporary: TemporaryDirectory[str] | None = field(default=None)

    @property
    def runs(self) -> list[Run]:
        """The runs, read anew."""
        names = [piece.name for piece in self.pieces if piece.keep]
        return read_runs([self.folder / f"{name}.csv" for name in names], self.rig)

    def to_dict(self) -> dict[str, Any]:
        """The ledger."""
        return dict(self.ledger)
