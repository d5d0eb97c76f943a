"""Output files: refused before the long work where they cannot be, written together after it."""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

from jbf.errors import InputError
from jbf.text_files import write_text

STDOUT = "-"


def check(outputs: Mapping[str, str | None], inputs: Iterable[str | os.PathLike[str]] = ()) -> None:
    """Refuse outputs that could not be written, or that would replace one another or an input.

    Parameters
    ----------
    outputs
        Option, such as `--out`, to the path given with it.
    inputs
        Files that the command reads.

    Raises
    ------
    InputError
        Names the option and the path; nothing has been written.
    """
    taken = {Path(item).resolve(): "is also an input" for item in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        target = Path(path) if path == STDOUT else Path(path).resolve()
        if target in taken:
            raise InputError(
                file=f"{option} {path}", problem=taken[target], mend="name another file"
            )
        taken[target] = "is also the file of another option"
        if path != STDOUT:
            _check_writable(option, path)


def _check_writable(option: str, path: str) -> None:
    def wrong(problem: str, mend: str) -> InputError:
        return InputError(file=f"{option} {path}", problem=problem, mend=mend)

    target = Path(path)
    if not path:
        raise wrong("is not a file name", "name a file")
    try:
        if target.is_dir():
            raise wrong("is a folder", "name a file in it")
        if target.exists() and not target.is_file():
            return  # a pipe or a device
        if not target.resolve().parent.is_dir():
            raise wrong("its folder does not exist", "make the folder or correct the path")
        # Permission bits do not tell of read-only disks or of too long names; a try does.
        trial = target.resolve().with_name(f".{target.name}.{secrets.token_hex(4)}.tmp")
        trial.touch(exist_ok=False)
        trial.unlink()
    except InputError:
        raise
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise wrong(f"cannot be written ({reason})", "check the path and its permissions") from None


def check_folder(argument: str, path: Path) -> None:
    """Make a folder for outputs where there is none.

    Raises
    ------
    InputError
        Something else has that name, or the folder cannot be made or written to.
    """
    try:
        path.mkdir(exist_ok=True)
    except FileExistsError:
        raise InputError(
            file=f"{argument} {path}", problem="is a file, not a folder", mend="name a folder"
        ) from None
    except FileNotFoundError:
        raise InputError(
            file=f"{argument} {path}",
            problem="its parent folder does not exist",
            mend="make it or correct the path",
        ) from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            file=f"{argument} {path}",
            problem=f"cannot be made ({reason})",
            mend="check the path and its permissions",
        ) from None
    _check_writable(argument, str(path / "report.html"))


def write(texts: Mapping[str, str]) -> None:
    """Write each text to its path; `-` is standard output."""
    for path, text in texts.items():
        if path == STDOUT:
            sys.stdout.write(text)
        else:
            write_text(path, text)


def say(text: str, outputs: Mapping[str, str | None]) -> None:
    """Print for people, unless an output has taken standard output."""
    if STDOUT not in outputs.values():
        print(text)
