"""Provenance of the numbers on a page: files, their hashes, and one hash over all samples."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from jbf.importing.ledger import file_hash

if TYPE_CHECKING:
    from jbf.records.run import Run

SHOWN = 16
"""Number of hexadecimal digits shown of a file's hash.

The hash over all samples is shown in full.
"""


def fingerprint(runs: Sequence[Run]) -> str:
    """SHA-256 hash over names and samples of the runs, as used in the fit."""
    digest = hashlib.sha256()
    for run in runs:
        digest.update(run.name.encode("utf-8", errors="replace"))
        for name, values in run.columns().items():
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return digest.hexdigest()


def file_rows(runs: Iterable[Run]) -> list[tuple[str, str, str]]:
    """Run, file and SHA-256 prefix of each run that was read from a file.

    A file that no longer exists is marked as such.
    """
    rows = []
    for run in runs:
        if run.path is None:
            continue
        try:
            rows.append((run.name, str(run.path), file_hash(run.path)[:SHOWN]))
        except OSError:
            rows.append((run.name, str(run.path), "no longer present"))
    return rows
