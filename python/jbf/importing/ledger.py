"""Ledger of an import (`import.json`).

The ledger records which file became which run, in which units, and what was left out.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from jbf._core import __version__
from jbf.importing.cutting.piece import Piece
from jbf.importing.formats.registry import format_of
from jbf.importing.mapping import Map
from jbf.importing.spool import Recording

NAME = "import.json"
_PART = 1 << 20


def file_hash(path: Path) -> str:
    """SHA-256 of a file, or of all files of a folder in the order of their names."""
    digest = hashlib.sha256()
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    for file in files:
        with file.open("rb") as open_file:
            while part := open_file.read(_PART):
                digest.update(part)
    return digest.hexdigest()


def ledger_of(
    recordings: Sequence[Recording], pieces: Sequence[Piece], mapping: Map
) -> dict[str, Any]:
    """Create the ledger of an import as plain values."""
    return {
        "jbf": __version__,
        "map": {
            "columns": dict(mapping.columns),
            "clocks": dict(mapping.clocks),
            "file": {k: v for k, v in asdict(mapping.options).items() if v not in (None, ())},
            "cut_by": list(mapping.cut.by or ()),
            **({"align": dict(mapping.align)} if mapping.align else {}),
        },
        "files": [_page(recording, pieces) for recording in recordings],
    }


def _page(recording: Recording, pieces: Sequence[Piece]) -> dict[str, Any]:
    """Ledger entry of a recording: its file, channels, notes, runs and omitted pieces."""
    file_pieces = [piece for piece in pieces if piece.file == recording.path.name]
    return {
        "file": recording.path.name,
        "sha256": file_hash(recording.path),
        "format": recording.format,
        "start": recording.start,
        **_further_files(recording),
        "channels": recording.channels,
        "dropped": [
            {k: v for k, v in asdict(d).items() if v is not None} for d in recording.dropped
        ],
        "notes": recording.notes,
        "runs": [_span(piece) | {"name": piece.name} for piece in file_pieces if piece.keep],
        "left_out": [_span(piece) | {"why": piece.why} for piece in file_pieces if not piece.keep],
    }


def _further_files(recording: Recording) -> dict[str, Any]:
    """Ledger entry on the further files of a recording and the alignment of their clocks."""
    if not recording.beside:
        return {}
    aligned = {alignment.file: alignment.to_dict() for alignment in recording.alignments}
    return {
        "beside": [
            {
                "file": path.name,
                "sha256": file_hash(path),
                "format": format_of(path).name,
                "alignment": aligned.get(path),
            }
            for path in recording.beside
        ]
    }


def _span(piece: Piece) -> dict[str, Any]:
    """Start and end of a piece, s, and the number of its stretch if it is not the first."""
    content: dict[str, Any] = {"from_s": piece.from_s, "to_s": piece.to_s}
    return content | ({"stretch": piece.segment + 1} if piece.segment else {})


def ledgers_of_runs(paths: Iterable[Path | None]) -> list[dict[str, Any]]:
    """Ledgers in the folders of given runs; unreadable ledgers are skipped."""
    folders = dict.fromkeys(path.resolve().parent for path in paths if path is not None)
    ledgers = []
    for folder in folders:
        try:
            content = json.loads((folder / NAME).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            continue
        if isinstance(content, dict) and isinstance(content.get("files"), list):
            ledgers.append(content)
    return ledgers
