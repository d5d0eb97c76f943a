"""Editable list of the pieces of each recording (`cut.toml`), one line per piece."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.importing.cutting.cut import ends
from jbf.importing.cutting.piece import Piece
from jbf.importing.spool import Recording
from jbf.records.toml_file import number, read_toml, refuse_unknown, table

_KEYS = ("name", "file", "from_s", "to_s", "keep", "stretch", "why")
_HEAD = """\
# Cuts of the recordings. Edit names, times (s; numbers of steady states) and keep, add and remove
# lines, then:
#   jbf import FILE... --map map.toml --cut cut.toml --folder FOLDER
# Both instants belong to the run. If time restarts in a file, stretch counts from 1.
"""


def trims_text(pieces: Sequence[Piece]) -> str:
    """Text of `cut.toml` for the pieces of recordings."""
    lines = [_HEAD + "pieces = ["]
    for piece in pieces:
        words = [
            f"name = {_text(piece.name)}",
            f"file = {_text(piece.file)}",
            f"from_s = {piece.from_s!r}",
            f"to_s = {piece.to_s!r}",
            f"keep = {str(piece.keep).lower()}",
        ]
        if piece.segment:
            words.append(f"stretch = {piece.segment + 1}")
        if piece.why:
            words.append(f"why = {_text(piece.why)}")
        lines.append(f"  {{ {', '.join(words)} }},")
    return "\n".join([*lines, "]\n"])


def _text(word: str) -> str:
    """Quote a string for TOML."""
    quoted = word.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{quoted}"'


def trimmed(path: Path, recordings: Sequence[Recording]) -> list[Piece]:
    """Read the pieces of recordings from an edited `cut.toml`.

    Raises
    ------
    InputError
        If the file is invalid, or names a file or an instant that does not exist.
    """
    content = read_toml(path)
    try:
        refuse_unknown(content, ["pieces"])
        rows = content.get("pieces", [])
        if not isinstance(rows, list):
            raise InputError(
                key="pieces", problem="is not a list", remedy="write pieces = [ { ... }, ]"
            )
        pieces = [_piece(row, at, recordings) for at, row in enumerate(rows, 1)]
        names = [piece.name for piece in pieces if piece.keep]
        for at, name in enumerate(names):
            if name in names[:at]:
                raise InputError(
                    key="pieces", problem=f'two runs are called "{name}"', remedy="rename one"
                )
    except InputError as error:
        raise error.within(file=path) from None
    return pieces


def _piece(row: object, at: int, recordings: Sequence[Recording]) -> Piece:
    """Convert entry number `at` of the file to a piece."""
    key = f"pieces, {at}"
    content: Mapping[str, Any] = table(row, key)
    refuse_unknown(content, _KEYS, f"{key}, ")
    for needed in ("name", "file", "from_s", "to_s"):
        if needed not in content:
            raise InputError(key=f"{key}, {needed}", problem="is missing", remedy="add it")
    matching = [r for r in recordings if r.path.name == content["file"]]
    if not matching:
        names = ", ".join(r.path.name for r in recordings)
        problem = f'"{content["file"]}" is not imported'
        raise InputError(key=f"{key}, file", problem=problem, remedy=f"known: {names}")
    segment = int(number(content.get("stretch", 1), f"{key}, stretch")) - 1
    if not 0 <= segment < matching[0].segments:
        problem = f"there is no stretch {segment + 1}"
        remedy = f"time restarts {matching[0].segments - 1} times in {matching[0].path.name}"
        raise InputError(key=f"{key}, stretch", problem=problem, remedy=remedy)
    from_s, to_s = (number(content[k], f"{key}, {k}") for k in ("from_s", "to_s"))
    first_s, last_s = ends(matching[0], segment)
    if not from_s < to_s or to_s < first_s or from_s > last_s:
        raise InputError(
            key=f"{key}, from_s",
            problem=f"{from_s:g} s to {to_s:g} s contains no samples",
            remedy=f"the recording covers {first_s:g} s to {last_s:g} s",
        )
    keep = content.get("keep", True)
    if not isinstance(keep, bool):
        raise InputError(
            key=f"{key}, keep", problem="is not true or false", remedy="write true or false"
        )
    name = str(content["name"])
    if keep and (not name or set(name) & set('/\\:*?"<>|') or name.startswith(".")):
        raise InputError(
            key=f"{key}, name", problem="is not a valid file name", remedy="use letters and digits"
        )
    return Piece(
        name, matching[0].path.name, segment, from_s, to_s, keep, str(content.get("why", ""))
    )
