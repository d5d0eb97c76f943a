"""Output files of a command: checked before the computation, written together after it."""

from __future__ import annotations

import os
import secrets
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from jbf.errors import InputError, Stopped, Unfinished, printable
from jbf.text_files import real_path, write_texts

STDOUT = "-"


def inputs_in(*named: str | Iterable[str] | None) -> Iterator[Path]:
    """Yield every named file or folder, and the rigs and runs inside the named folders."""
    for value in named:
        for item in [value] if value is None or isinstance(value, str) else value:
            if item is None:
                continue
            yield Path(item)
            if os.path.isdir(item):
                yield from _campaign_files(Path(item))


def _campaign_files(folder: Path) -> Iterator[Path]:
    try:
        inside = list(folder.iterdir())
    except OSError:
        return  # reported where the folder is read
    yield from (p for p in inside if p.suffix.lower() == ".csv" or p.name == "rig.toml")


def check(outputs: Mapping[str, str | None], inputs: Iterable[str | os.PathLike[str]] = ()) -> None:
    """Raise an InputError for outputs that cannot be written or that would replace other files.

    An output must not replace an input or another output.

    Parameters
    ----------
    outputs
        Mapping of options, such as `--out`, to the given paths.
    inputs
        Files that the command reads.

    Raises
    ------
    InputError
        Names the option and the path; nothing has been written.
    """
    conflicts = {real_path(item): "is also an input" for item in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        target = Path(path) if path == STDOUT else real_path(path)
        if target in conflicts:
            raise InputError(
                file=f"{option} {path}", problem=conflicts[target], remedy="choose another file"
            )
        conflicts[target] = "is also the file of another option"
        if path != STDOUT:
            _check_writable(option, path)


def _check_writable(option: str, path: str) -> None:
    def wrong(problem: str, remedy: str) -> InputError:
        return InputError(file=f"{option} {path}", problem=problem, remedy=remedy)

    target = Path(path)
    if not path:
        raise wrong("is not a file name", "name a file")
    try:
        if real_path(target).is_symlink():
            raise wrong("is a link to itself", "choose another file")
        if target.is_dir():
            raise wrong("is a folder", "name a file in it")
        if target.exists() and not target.is_file():
            return  # a pipe or a device
        if not real_path(target).parent.is_dir():
            raise wrong("its folder does not exist", "create the folder or correct the path")
        # Permission bits do not reveal read-only disks or names that are too long; a test file
        # does.
        trial = real_path(target).with_name(f".{target.name}.{secrets.token_hex(4)}.tmp")
        try:
            trial.touch(exist_ok=False)
        finally:
            trial.unlink(missing_ok=True)
    except InputError:
        raise
    except (OSError, ValueError) as error:
        reason = (getattr(error, "strerror", None) or str(error)).lower()
        raise wrong(f"cannot be written ({reason})", "check the path and its permissions") from None


def check_folder(argument: str, path: Path) -> None:
    """Create the output folder of a command if it does not exist.

    Raises
    ------
    InputError
        The name is that of a file, or the folder cannot be created or written to.
    """
    try:
        path.mkdir(exist_ok=True)
    except FileExistsError:
        raise InputError(
            file=f"{argument} {path}", problem="is a file, not a folder", remedy="name a folder"
        ) from None
    except FileNotFoundError:
        raise InputError(
            file=f"{argument} {path}",
            problem="its parent folder does not exist",
            remedy="create it or correct the path",
        ) from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(
            file=f"{argument} {path}",
            problem=f"cannot be created ({reason})",
            remedy="check the path and its permissions",
        ) from None
    _check_writable(argument, str(path / "report.html"))


class PartialResultSaved(KeyboardInterrupt):
    """Interrupt of a command whose best result so far was written; `str` names the file."""


def keep(stop: Stopped, out: str | None) -> PartialResultSaved:
    """Write the best model of an interrupted command to the path of the complete one.

    Parameters
    ----------
    out
        Path given with `--out`, if any.
    """
    fit = stop.fit
    model = " + ".join([fit.model.law, *fit.model.effects])
    unit = fit.model.rig.quantities.force
    text = f"interrupted; the best model so far is {model}, RMS {fit.rms:.3g} {unit}"
    if out is None:
        say(fit.summary(), {})
        return PartialResultSaved(f"{text}, not finished")
    write({out: fit.model.to_toml()})
    return PartialResultSaved(
        f"{text}, written to {'standard output' if out == STDOUT else out}, not finished"
    )


def keep_unfinished(
    end: Unfinished, out: str | None, json: str | None = None, report: str | None = None
) -> Unfinished:
    """Write the partial results of a computation beyond its budget, and report that in the error.

    Parameters
    ----------
    out, json, report
        Paths given with `--out`, `--json` and `--report`, if any. They receive the best model so
        far, the error with that fit, and the report of that fit.
    """
    texts = {}
    if json is not None:
        from jbf.reporting.json import json_text

        status = {"verdict": None, "unfinished": str(end)}
        texts[json] = json_text({**status, "fit": None if end.fit is None else end.fit.to_dict()})
    if end.fit is not None and out is not None:
        texts[out] = end.fit.model.to_toml()
    if end.fit is not None and report is not None:
        from jbf.reporting.text_pages import fit_page

        texts[report] = fit_page(end.fit)
    write(texts)
    if texts:
        names = ["standard output" if path == STDOUT else path for path in texts]
        end.problem += f", written to {', '.join(names)}"
    return end


def write(texts: Mapping[str, str | bytes]) -> None:
    """Write each text or archive to its path, all or none; `-` is standard output, for texts."""
    write_texts({path: text for path, text in texts.items() if path != STDOUT})
    printed = texts.get(STDOUT)
    if isinstance(printed, str):
        if sys.stdout is None:
            raise InputError(
                file="standard output", problem="is closed", remedy="name a file in place of -"
            )
        _print(printed, data=True)


def say(text: str, outputs: Mapping[str, str | None]) -> None:
    """Print a message on standard output, unless this is closed or is the path of an output."""
    if STDOUT not in outputs.values() and sys.stdout is not None:
        _print(printable(text) + "\n")


def complain(text: object) -> None:
    """Print one line on standard error, unless this is closed."""
    if sys.stderr is not None:
        print(f"jbf: {printable(str(text))}", file=sys.stderr)


def flush() -> None:
    """Flush standard output; raise an InputError if that fails, for example on a full disk."""
    _print("")


def drop_stdout() -> None:
    """Redirect standard output to the null device.

    Otherwise Python would report the error again when it closes standard output.
    """
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _print(text: str, *, data: bool = False) -> None:
    """Print text on standard output, with a defined handling of a closed pipe."""
    if sys.stdout is None:
        return
    try:
        raw = getattr(sys.stdout, "buffer", None) if data else None
        if raw is None:
            sys.stdout.write(text)
        else:
            # Write the same bytes as to a file, whatever the terminal's encoding.
            sys.stdout.flush()
            raw.write(text.encode("utf-8", errors="replace"))
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        drop_stdout()
        raise InputError(
            file="standard output",
            problem=f"cannot be written ({(error.strerror or type(error).__name__).lower()})",
            remedy="redirect the output to another place",
        ) from None
