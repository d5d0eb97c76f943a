"""Reading and writing of complete text files; every failure is a one-line error for the user."""

from __future__ import annotations

import os
import secrets
import select
import stat
from collections.abc import Mapping
from pathlib import Path

from jbf.errors import InputError, closest, printable, quoted

PIPE_S = 10.0
"""Timeout for data from a pipe, s."""
PIPE_BYTES = 1 << 30
"""Largest number of bytes from a pipe; beyond it the pipe is assumed to be endless."""
LARGEST_BYTES = 1 << 29
"""Largest size of a text that is read at once.

A table parsed from the text requires about fourteen times as much memory.
"""
_PACKED = {
    b"\x1f\x8b": ("is compressed (gzip), not text", "unpack it"),
    b"PK\x03\x04": (
        "is an archive or a spreadsheet, not text",
        "unpack it, or save the sheet as CSV; jbf import reads spreadsheets",
    ),
}
"""First bytes of files that are often mistaken for text."""


def os_error(path: Path, error: OSError, doing: str) -> InputError:
    """Error for a failed file operation; `doing` is "read" or "written"."""
    if isinstance(error, FileNotFoundError):
        try:
            guess = closest(path.name, (entry.name for entry in path.parent.iterdir()), 0.8)
        except OSError:
            return InputError(
                file=path, problem="its folder does not exist", remedy="correct the path"
            )
        remedy = f"did you mean {quoted(guess)}?" if guess else "correct the path"
        return InputError(file=path, problem="the file does not exist", remedy=remedy)
    if isinstance(error, IsADirectoryError):
        return InputError(file=path, problem="is a folder", remedy="name a file in it")
    reason = (error.strerror or type(error).__name__).lower()
    return InputError(
        file=path,
        problem=f"cannot be {doing} ({reason})",
        remedy="check the path and its permissions",
    )


def name_of(path: Path, depth: int = 1) -> str:
    """Name of a file without its suffix, with `depth - 1` parent folders.

    Terminal control characters, and bytes that are not UTF-8, are escaped.
    """
    text = "/".join(path.with_suffix("").parts[-depth:])
    return printable(os.fsencode(text).decode("utf-8", errors="backslashreplace"))


def path_of(value: object) -> Path:
    """Convert to a path; raise an InputError if the value is not one."""
    if not isinstance(value, str | os.PathLike):
        type_name = "None" if value is None else type(value).__name__
        raise InputError(problem=f"{type_name} is not a path", remedy="name a file or a folder")
    return Path(value)


def real_path(path: str | os.PathLike[str]) -> Path:
    """Resolve symbolic links; a loop of links does not raise an error."""
    try:
        return Path(os.path.realpath(path))
    except ValueError:  # a null character in the name itself
        raise InputError(
            file=quoted(path), problem="is not a file name", remedy="correct it"
        ) from None


def check_readable(path: Path, *, pipes: bool = True) -> None:
    """Raise an InputError for a device, or for a file that cannot be opened.

    Parameters
    ----------
    pipes
        True if pipes are accepted.
    """
    try:
        kind = path.stat().st_mode
    except OSError as error:
        raise os_error(path, error, "read") from None
    except ValueError:  # a null character in the name itself
        raise InputError(
            file=quoted(path), problem="is not a file name", remedy="correct it"
        ) from None
    if stat.S_ISCHR(kind) or stat.S_ISBLK(kind):
        raise InputError(file=path, problem="is a device, not a file", remedy="name a file")
    if stat.S_ISFIFO(kind):
        if not pipes:
            remedy = "write what comes out of it to a file"
            raise InputError(file=path, problem="is a pipe, not a file", remedy=remedy)
        return
    try:
        path.open("rb").close()
    except OSError as error:
        raise os_error(path, error, "read") from None


def read_bytes(path: Path) -> bytes:
    """Read the content of a file, or of a pipe.

    Raises
    ------
    InputError
        The file is missing, a folder, a device, too large or unreadable; a pipe is endless or
        provides no data.
    """
    check_readable(path)
    try:
        size = path.stat().st_size
        if size > LARGEST_BYTES:
            raise InputError(
                file=path,
                problem=f"has {size / 1e9:.2g} GB; what is read whole may have "
                f"{LARGEST_BYTES / 1e9:.2g} GB",
                remedy="cut it into runs: jbf import reads files of any size",
            )
        return _from_pipe(path) if path.is_fifo() else path.read_bytes()
    except OSError as error:
        raise os_error(path, error, "read") from None


def _from_pipe(path: Path) -> bytes:
    # Non-blocking, because a writer may never open the pipe.
    pipe = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        if not select.select([pipe], [], [], PIPE_S)[0]:
            raise InputError(
                file=path,
                problem=f"nothing comes out of this pipe within {PIPE_S:g} s",
                remedy="start what fills it first",
            )
        os.set_blocking(pipe, True)
        parts, size = [], 0
        while part := os.read(pipe, 1 << 20):
            parts.append(part)
            size += len(part)
            if size > PIPE_BYTES:
                remedy = "write it to a file"
                problem = f"is longer than {PIPE_BYTES} bytes and still comes"
                raise InputError(file=path, problem=problem, remedy=remedy)
        return b"".join(parts)
    finally:
        os.close(pipe)


def read_text(path: str | os.PathLike[str]) -> str:
    """Read the text of a UTF-8 file, without a byte order mark.

    Raises
    ------
    InputError
        The file is missing, a folder, unreadable, binary, or not UTF-8.
    """
    path = path_of(path)
    data = read_bytes(path)
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(file=path, problem="is UTF-16 text", remedy="save it as UTF-8")
    for first, (problem, remedy) in _PACKED.items():
        if data.startswith(first):
            raise InputError(file=path, problem=problem, remedy=remedy)
    if b"\0" in data:
        raise InputError(file=path, problem="is binary, not text", remedy="name a text file")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            file=path,
            row=error.object[: error.start].count(b"\n") + 1,
            problem="is not UTF-8 text",
            remedy="save the file as UTF-8",
        ) from None


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 file atomically, as `write_texts` does."""
    write_texts({path: text})


def write_texts(texts: Mapping[str | os.PathLike[str], str | bytes]) -> None:
    """Write UTF-8 files, each of them atomically; bytes are written as they are.

    A concurrent reader sees the complete old file or the complete new one. Each text is first
    written to a temporary file in the same folder. Once all are complete, they are renamed. If one
    text cannot be staged, no file is replaced. A pipe or device is written to directly.

    Raises
    ------
    InputError
        A file cannot be written; no temporary file remains, even after Ctrl-C.
    """
    staged: list[tuple[Path, Path]] = []
    try:
        for path, text in texts.items():
            data = text if isinstance(text, bytes) else text.encode("utf-8", errors="replace")
            _stage(path_of(path), data, staged)
        for temporary, target in staged:
            try:
                os.replace(temporary, target)
            except OSError as error:
                raise os_error(target, error, "written") from None
    finally:
        for temporary, _ in staged:
            temporary.unlink(missing_ok=True)


def _stage(path: Path, data: bytes, staged: list[tuple[Path, Path]]) -> None:
    """Write `data` to a temporary file, which is added to `staged` before its creation."""
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(data)
            return
        target = real_path(path)  # a symbolic link keeps pointing to its file
        temporary = target.with_name(f".{target.name[:100]}.{secrets.token_hex(6)}.tmp")
        staged.append((temporary, target))
        temporary.write_bytes(data)
    except OSError as error:
        raise os_error(path, error, "written") from None
