"""Access to the folder that the page may read, restricted to names inside it."""

from __future__ import annotations

import filecmp
import os
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path, PurePosixPath
from typing import Any

from jbf.errors import InputError, quoted
from jbf.importing.formats.registry import FORMATS
from jbf.importing.ledger import NAME as LEDGER
from jbf.records.toml_file import read_toml

MOST_FILES = 2000
"""Maximum number of listed files; for more, choose a smaller folder."""
DEPTH = 4
"""Maximum depth of nested folders."""
_LARGEST_TOML = 1 << 20
_RIG = {"bearing", "lubricant", "load", "drive"}
_RECORDINGS = {suffix for kind in FORMATS for suffix in kind.suffixes} - {".csv"}
_UPLOADS = _RECORDINGS | {".csv", ".toml", ".zip"}
_OWN = {LEDGER, "workbench.json"}
"""Files that the program writes itself; they are not recordings."""
_TRUTH = "truth.json"
"""Answer of a simulated campaign, which is not listed as a recording."""


@dataclass(frozen=True)
class Folder:
    """Folder of a session; names are paths relative to it, with `/` between their parts."""

    root: Path

    @classmethod
    def of(cls, path: str | os.PathLike[str]) -> Folder:
        """Open a folder for a session.

        Raises
        ------
        InputError
            The folder does not exist.
        """
        root = Path(os.path.realpath(path))
        if not root.is_dir():
            raise InputError(file=path, problem="is not a folder", remedy="name an existing folder")
        return cls(root)

    def path(self, name: str) -> Path:
        """Path of a file or folder with this name, with links resolved.

        Raises
        ------
        InputError
            The name is not valid, or leads outside the folder.
        """
        parts = PurePosixPath(name).parts
        is_invalid = (
            not parts or "\0" in name or "\\" in name or ".." in parts or name.startswith("/")
        )
        if not is_invalid:
            resolved = Path(os.path.realpath(self.root.joinpath(*parts)))
            if resolved.is_relative_to(self.root) and resolved != self.root:
                return resolved
        raise InputError(
            file=quoted(name),
            problem="is not a name in the folder",
            remedy="choose an existing one",
        )

    def name(self, path: Path) -> str:
        """Name of a path within the folder."""
        return Path(os.path.realpath(path)).relative_to(self.root).as_posix()

    def check_upload(self, name: str) -> None:
        """Check the name of an uploaded file.

        Raises
        ------
        InputError
            The name contains a folder, is hidden, is that of a file that jbf writes, or its kind
            is not supported.
        """
        kind = PurePosixPath(name).suffix.lower()
        if name in _OWN:
            raise InputError(
                file=quoted(name),
                problem="is written by jbf; it is not a recording",
                remedy="drop a recording, or session.zip to continue a session",
            )
        if "/" in name or "\\" in name or name.startswith(".") or kind not in _UPLOADS:
            endings = ", ".join(sorted(_UPLOADS))
            raise InputError(
                file=quoted(name),
                problem="is not a recording, rig, map or session",
                remedy=f"give {endings}",
            )
        self.path(name)

    def add(self, upload: Path, name: str) -> str:
        """Move an uploaded file into the folder, and return its name there.

        If a file with this name and content exists, it is kept and the upload is removed. If it
        has other content, the upload is given a number, as in `log_2.csv`.
        """
        path = PurePosixPath(name)
        for candidate in chain([name], (f"{path.stem}_{k}{path.suffix}" for k in count(2))):
            target = self.root / candidate
            if not os.path.lexists(target):
                os.replace(upload, target)
                return candidate
            if target.is_file() and filecmp.cmp(upload, self.path(candidate), shallow=False):
                upload.unlink()
                return candidate
        raise AssertionError  # the names do not end

    def listing(self) -> dict[str, Any]:
        """Campaigns (a rig and runs in one folder) and files by kind; sessions are archives."""
        names_by_kind: dict[str, Any] = {
            "rigs": [],
            "maps": [],
            "models": [],
            "csv": [],
            "other": [],
            "sessions": [],
        }
        for number, path in enumerate(self._walk()):
            if number == MOST_FILES:
                names_by_kind["more"] = True
                break
            suffix, name = path.suffix.lower(), self._listed(path)
            if suffix == ".toml":
                kind = _toml_kind(path)
                if kind:
                    names_by_kind[kind].append(name)
            elif suffix == ".csv":
                names_by_kind["csv"].append(name)
            elif suffix == ".zip":
                names_by_kind["sessions"].append(name)
            elif suffix in _RECORDINGS and path.name not in _OWN | {_TRUTH}:
                names_by_kind["other"].append(name)
        names_by_kind["campaigns"] = [
            {"rig": rig, "runs": runs}
            for rig in names_by_kind["rigs"]
            if (runs := [c for c in names_by_kind["csv"] if _parent(c) == _parent(rig)])
        ]
        return names_by_kind

    def _listed(self, path: Path) -> str:
        return path.relative_to(self.root).as_posix()

    def _walk(self) -> Iterator[Path]:
        for folder, folders, files in os.walk(self.root):
            depth = len(Path(folder).relative_to(self.root).parts)
            folders[:] = sorted(f for f in folders if not f.startswith(".") and depth < DEPTH)
            for file in sorted(files):
                if not file.startswith("."):
                    yield Path(folder) / file


def _parent(name: str) -> str:
    return PurePosixPath(name).parent.as_posix()


def _toml_kind(path: Path) -> str | None:
    """Kind of a TOML file: `rigs`, `maps` or `models`; None for any other file."""
    try:
        if path.stat().st_size > _LARGEST_TOML:
            return None
        keys = set(read_toml(path))
    except (InputError, OSError):
        return None
    if "law" in keys:
        return "models"
    if "columns" in keys:
        return "maps"
    return "rigs" if keys & _RIG else None
