"""Write a campaign folder (runs, rig, map, trims and ledger) completely or not at all."""

from __future__ import annotations

import json
import os
import secrets
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from jbf.errors import InputError
from jbf.importing.cutting.piece import Piece
from jbf.importing.cutting.trims import trims_text
from jbf.importing.ledger import NAME
from jbf.importing.mapping import Map
from jbf.importing.run_text import run_text
from jbf.importing.spool import Recording
from jbf.records.rig import Rig
from jbf.text_files import os_error, real_path

Report = Callable[[str, int, int], None]


def check_folder(path: Path, *, replace: bool, holding: Sequence[str] = ()) -> None:
    """Raise an InputError if a folder is not writable or contains files not written by an import.

    Parameters
    ----------
    holding
        Names of subfolders with imports that the folder may already contain.

    Raises
    ------
    InputError
        With the name of the folder.
    """

    def wrong(problem: str, remedy: str) -> InputError:
        return InputError(file=path, problem=problem, remedy=remedy)

    if os.path.exists(path) and not os.path.isdir(path):
        raise wrong("is a file, not a folder", "name a folder")
    try:
        holds = os.path.isdir(path) and any(p.name not in holding for p in path.iterdir())
    except OSError as error:
        raise os_error(path, error, "read") from None
    if holds:
        if not (path / NAME).is_file():
            raise wrong("is not empty", "name a new folder")
        if not replace:
            raise wrong("contains an import already", "name a new folder, or use --force")
    parent = real_path(path).parent
    try:
        if not parent.is_dir():
            raise wrong("its parent folder does not exist", "create it or correct the path")
        TemporaryDirectory(prefix=".jbf-import-", dir=parent).cleanup()
    except OSError as error:
        raise os_error(path, error, "written") from None


def write_campaign(
    path: Path,
    rig: Rig,
    recordings: Sequence[Recording],
    pieces: Sequence[Piece],
    mapping: Map,
    map_text: str,
    ledger: dict[str, Any],
    report: Report | None = None,
) -> None:
    """Write a campaign folder under a temporary name, and rename it when it is complete.

    Raises
    ------
    InputError
        If the folder cannot be written; no partial folder remains.
    """
    target = real_path(path)
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(6)}.tmp")
    runs = [piece for piece in pieces if piece.keep]
    by_file = {recording.path.name: recording for recording in recordings}
    try:
        temporary.mkdir()
        for number, piece in enumerate(runs):
            if report is not None:
                report(f"writing {piece.name}", number, len(runs))
            with (temporary / f"{piece.name}.csv").open("w", encoding="utf-8") as file:
                for part in run_text(by_file[piece.file], piece):
                    file.write(part)
        rig.write(temporary / "rig.toml")
        (temporary / "map.toml").write_text(map_text, encoding="utf-8")
        (temporary / "cut.toml").write_text(trims_text(pieces), encoding="utf-8")
        text = json.dumps(ledger, indent=1, ensure_ascii=False)
        (temporary / NAME).write_text(text + "\n", encoding="utf-8")
        _put(temporary, target)
    except OSError as error:
        reason = (error.strerror or type(error).__name__).lower()
        problem = f"cannot be written ({reason})"
        remedy = "check the path and its permissions"
        raise InputError(file=path, problem=problem, remedy=remedy) from None
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _put(temporary: Path, target: Path) -> None:
    """Rename the temporary folder to its target; delete an earlier import only afterwards."""
    if not target.exists():
        os.replace(temporary, target)
        return
    old = target.with_name(f".{target.name}.{secrets.token_hex(6)}.old")
    os.replace(target, old)
    try:
        os.replace(temporary, target)
    except OSError:
        os.replace(old, target)
        raise
    shutil.rmtree(old, ignore_errors=True)
