"""What a page's numbers were made from: the files, their hashes, and one hash of all samples."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from jbf.importing.ledger import file_hash

if TYPE_CHECKING:
    from jbf.records.run import Run

SHOWN = 16
"""Digits of a file's hash; those of all samples stand whole."""


def fingerprint(runs: Sequence[Run]) -> str:
    """SHA-256 over the names and the samples of runs, as they went into the fit."""
    digest = hashlib.sha256()
    for run in runs:
        digest.update(run.name.encode("utf-8", errors="replace"))
        for name, values in run.columns().items():
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(values, dtype="<f8").tobytes())
    return digest.hexdigest()


def file_rows(runs: Iterable[Run]) -> list[tuple[str, str, str]]:
    """Run, file and the beginning of its SHA-256, of those that came from files that are there."""
    rows = []
    for run in runs:
        if run.path is None:
            continue
        try:
            rows.append((run.name, str(run.path), file_hash(run.path)[:SHOWN]))
        except OSError:
            rows.append((run.name, str(run.path), "no longer there"))
    return rows
