"""Session as one file: a ZIP archive with the session file, the rig and the runs."""

from __future__ import annotations

import io
import json
import shutil
import zipfile
import zlib
from itertools import chain, count
from pathlib import Path, PurePosixPath
from typing import Any

from jbf.errors import InputError
from jbf.text_files import write_texts
from jbf.workbench.guard import LARGEST_UPLOAD
from jbf.workbench.session import Session
from jbf.workbench.session_file import FILE, checked, file_content, restore

SUFFIX = ".zip"
RIG = "rig.toml"
_UNREADABLE = (
    zipfile.BadZipFile, zlib.error, RuntimeError, OSError, EOFError, KeyError, TypeError,
    UnicodeDecodeError, json.JSONDecodeError,
)  # fmt: skip
"""Errors of a broken, incomplete, encrypted or unsupported archive."""


def bundle(session: Session) -> bytes:
    """Archive with the session file, the rig and all runs of the open rig of a session.

    Raises
    ------
    InputError
        No rig is open.
    """
    content = file_content(session)
    folder = session.folder
    names = {content["rig"]: RIG}
    for name in content["runs"]:
        names[name] = _unused(PurePosixPath(name).name, set(names.values()))
    content |= {"rig": RIG, "runs": [names[name] for name in content["runs"]]}
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(FILE, json.dumps(content, indent=1))
        for source, target in names.items():
            archive.write(folder.path(source), target)
    return file.getvalue()


def _unused(name: str, used: set[str]) -> str:
    """Name with a number if it is used already."""
    path = PurePosixPath(name)
    names = chain([name], (f"{path.stem}_{k}{path.suffix}" for k in count(2)))
    return next(candidate for candidate in names if candidate not in used)


def open_bundle(session: Session, name: str) -> None:
    """Unpack an archive of the folder into a new folder, and continue its session.

    Only the files that the session names are unpacked.

    Raises
    ------
    InputError
        The file is not an archive of a session, is larger than `LARGEST_UPLOAD`, or its session
        cannot be continued. The new folder is then removed.
    """
    path = session.folder.path(name)
    try:
        with zipfile.ZipFile(path) as archive:
            content, texts = _read(archive, path)
    except InputError:
        raise
    except _UNREADABLE as error:
        remedy = "save it again with Session as one file"
        raise InputError(
            file=name, problem=f"is not a session of the workbench ({error})", remedy=remedy
        ) from None
    stems = chain([path.stem], (f"{path.stem}_{k}" for k in count(2)))
    stem = next(s for s in stems if not session.folder.path(s).exists())
    folder = session.folder.path(stem)
    folder.mkdir()
    try:
        write_texts({folder / target: text for target, text in texts.items()})
        content["rig"] = f"{stem}/{content['rig']}"
        content["runs"] = [f"{stem}/{run}" for run in content["runs"]]
        restore(session, content, path)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _read(archive: zipfile.ZipFile, path: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Session file of an archive, and the texts of the rig and the runs by name."""
    if sum(info.file_size for info in archive.infolist()) > LARGEST_UPLOAD:
        problem = f"contains more than {LARGEST_UPLOAD >> 20} MiB"
        raise InputError(file=path, problem=problem, remedy="unpack it into the folder")
    content = checked(json.loads(archive.read(FILE)), path)
    names = [str(content["rig"]), *map(str, content["runs"])]
    for name in names:
        kind = PurePosixPath(name).suffix.lower()
        if name != PurePosixPath(name).name or "\\" in name or kind not in (".toml", ".csv"):
            raise InputError(
                file=path, problem=f"names {name!r}", remedy="use only files saved by jbf"
            )
    return content, {name: archive.read(name).decode("utf-8") for name in names}
