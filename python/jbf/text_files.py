"""Text files, read and written whole; each way that fails is one line for the user."""

from __future__ import annotations

import os
import secrets
from pathlib import Path

from jbf.errors import InputError, closest, quoted


def _os_error(path: Path, error: OSError, doing: str) -> InputError:
    if isinstance(error, FileNotFoundError):
        try:
            guess = closest(path.name, (entry.name for entry in path.parent.iterdir()), 0.8)
        except OSError:
            return InputError(
                file=path, problem="its folder does not exist", mend="correct the path"
            )
        mend = f"did you mean {quoted(guess)}?" if guess else "correct the path"
        return InputError(file=path, problem="the file does not exist", mend=mend)
    if isinstance(error, IsADirectoryError):
        return InputError(file=path, problem="is a folder", mend="name a file in it")
    reason = (error.strerror or type(error).__name__).lower()
    return InputError(
        file=path,
        problem=f"cannot be {doing} ({reason})",
        mend="check the path and its permissions",
    )


def path_of(value: object) -> Path:
    """A path; an InputError where something else stands for one."""
    if not isinstance(value, str | os.PathLike):
        shown = "None" if value is None else type(value).__name__
        raise InputError(problem=f"{shown} is not a path", mend="name a file or a folder")
    return Path(value)


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a UTF-8 file, without a byte order mark.

    Raises
    ------
    InputError
        The file is missing, a folder, unreadable, binary, or not UTF-8.
    """
    path = path_of(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _os_error(path, error, "read") from None
    except ValueError:  # a null character in the name itself
        raise InputError(
            file=quoted(path), problem="is not a file name", mend="correct it"
        ) from None
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(file=path, problem="is UTF-16 text", mend="save it as UTF-8")
    if b"\0" in data:
        raise InputError(file=path, problem="is binary, not text", mend="name a text file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            file=path,
            row=error.object[: error.start].count(b"\n") + 1,
            problem="is not UTF-8 text",
            mend="save the file as UTF-8",
        ) from None


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 file whole or not at all.

    A reader sees the old file or the new one, never a part: the text goes to a temporary file
    in the same folder, which then takes the name. A pipe or device is written to directly.

    Raises
    ------
    InputError
        The file cannot be written; nothing is left behind.
    """
    path = path_of(path)
    data = text.encode("utf-8", errors="replace")
    temporary: Path | None = None
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(data)
            return
        target = path.resolve()  # a link keeps pointing to its file
        temporary = target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.tmp")
        temporary.write_bytes(data)
        os.replace(temporary, target)
    except OSError as error:
        if temporary is not None:
            temporary.unlink(missing_ok=True)
        raise _os_error(path, error, "written") from None
