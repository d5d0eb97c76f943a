"""Result of an import."""

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
    """Result of an import: campaign folder, rig, runs and ledger.

    Attributes
    ----------
    folder : Path
        Folder with the runs as CSV, `rig.toml`, `map.toml`, `cut.toml` and `import.json`.
    rig : Rig
        Rig of the recordings.
    pieces : tuple of Piece
        Pieces of the recordings, including those that are left out.
    ledger : dict
        Contents of `import.json`: files, channels, units as read and converted, clocks, dropped
        rows and reasons.
    overviews : tuple of Overview
        Each recording reduced to few points, for plotting.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> imported = jbf.import_files("sweep.csv", whole=True)
    >>> [(piece.name, piece.keep) for piece in imported.pieces]
    [('sweep', True)]
    """

    folder: Path
    rig: Rig
    pieces: tuple[Piece, ...]
    ledger: Mapping[str, Any]
    overviews: tuple[Overview, ...] = ()
    # Kept as long as the result, if no folder was named.
    _temporary: TemporaryDirectory[str] | None = field(default=None)

    @property
    def runs(self) -> list[Run]:
        """Imported runs, read from the folder at each access."""
        names = [piece.name for piece in self.pieces if piece.keep]
        return read_runs([self.folder / f"{name}.csv" for name in names], self.rig)

    def to_dict(self) -> dict[str, Any]:
        """Return the ledger of the import as a dictionary."""
        return dict(self.ledger)
