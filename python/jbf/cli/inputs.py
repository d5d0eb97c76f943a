"""Reading what the command line names, with a hint where the wrong kind of file is given."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from jbf.errors import InputError
from jbf.models.chain import check_rig
from jbf.models.model import Model
from jbf.models.vocabulary import AUTO
from jbf.records.csv_file import read_run
from jbf.records.rig import Rig, read_rig
from jbf.records.run import Run
from jbf.records.run_files import read_runs
from jbf.records.toml_file import read_toml

_RIG_SECTIONS = {"bearing", "lubricant", "load", "drive"}


def rig(path: str, law: str) -> Rig:
    """The rig of a file, complete enough for a law; for any where the data are to choose it."""
    _refuse_csv(path, "RIG")
    try:
        found = read_rig(path)
        if law != AUTO:
            check_rig(found, law)
    except InputError as error:
        if {"law", "format", "effects"} & _keys(path):
            raise InputError(
                file=path,
                problem="is a model file, not a rig",
                mend="name the rig's TOML with [bearing], [lubricant] and [load], or with [drive]",
            ) from None
        raise error.within(file=path) from None
    return found


def model(path: str) -> Model:
    """The model of a file."""
    _refuse_csv(path, "MODEL")
    try:
        return Model.load(path)
    except InputError:
        keys = _keys(path)
        if keys & _RIG_SECTIONS and "law" not in keys:
            raise InputError(
                file=path,
                problem="is a rig, not a model file",
                mend=f"make a model first: jbf fit {path} RUN... --out model.toml",
            ) from None
        raise


def runs(items: Sequence[str], on: Rig, *, first: str) -> list[Run]:
    """The runs, on a rig, of files, folders and patterns; `first` is the argument before them."""
    for item in items:
        _refuse_toml(item, first)
    return read_runs(items, on)


def motion(item: str, on: Rig) -> Run:
    """One run, on a rig, that need not hold friction."""
    _refuse_toml(item, "MODEL")
    return read_run(item, on, need_friction=False)


def _keys(path: str) -> set[str]:
    try:
        return set(read_toml(path))
    except InputError:
        return set()


def _refuse_csv(path: str, argument: str) -> None:
    if Path(path).suffix.lower() == ".csv":
        raise InputError(
            file=path,
            problem=f"is a CSV file where {argument} should be",
            mend=f"name the TOML file first, then the runs: {argument} RUN...",
        )


def _refuse_toml(path: str, first: str) -> None:
    if Path(path).suffix.lower() == ".toml":
        raise InputError(
            file=path,
            problem="is a TOML file where a run should be",
            mend=f"name one {first} and then CSV files",
        )
