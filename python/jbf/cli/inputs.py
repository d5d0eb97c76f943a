"""Reading of the files named on the command line, with hints for files of a wrong kind."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from jbf.cli.progress import shown
from jbf.errors import InputError
from jbf.models.chain import check_rig, default_law, default_law_of_diagnosis
from jbf.models.model import Model
from jbf.models.vocabulary import AUTO
from jbf.records.csv_file import read_run
from jbf.records.rig import Rig, read_rig
from jbf.records.run import Run
from jbf.records.run_files import read_runs
from jbf.records.toml_file import read_toml

if TYPE_CHECKING:
    from jbf.importing.result import Import

_RIG_SECTIONS = {"bearing", "lubricant", "load", "drive"}
_imports: list[Import] = []
"""Imports kept until the command ends, because their temporary folders are deleted with them."""


def law_of_diagnosis(on: Rig, requested: str | None) -> str:
    """Law of a diagnosis: the requested one, otherwise the default for the rig."""
    return requested or default_law_of_diagnosis(on)


def law_of_fit(on: Rig, requested: str | None) -> str:
    """Law of a fit: the requested one, otherwise the default for the rig."""
    return requested or default_law(on)


def campaign(rig_or_map: str, items: Sequence[str], law: str | None) -> tuple[Rig, list[Run]]:
    """Read the rig and the runs that the arguments of a command name.

    The source is `rig.toml` with CSV files, a folder written by an import, or a map with
    recordings.
    """
    if os.path.isdir(rig_or_map):
        rig_content = rig(str(Path(rig_or_map) / "rig.toml"), law)
        return rig_content, runs(items or [rig_or_map], rig_content, first="RIG")
    if is_map(rig_or_map):
        imported = recordings(rig_or_map, items)
        _check(imported[0], law)
        return imported
    rig_content = rig(rig_or_map, law)
    return rig_content, runs(items, rig_content, first="RIG")


def is_map(path: str) -> bool:
    """Whether a file is a map of `jbf import`, by its top-level TOML keys."""
    return Path(path).suffix.lower() != ".csv" and "columns" in _keys(path)


def is_model(path: str) -> bool:
    """Whether a file is a model file, by its top-level TOML keys."""
    return Path(path).suffix.lower() != ".csv" and "law" in _keys(path)


def recordings(map_path: str, items: Sequence[str]) -> tuple[Rig, list[Run]]:
    """Import recordings through a map into a temporary campaign; return its rig and runs."""
    from jbf.importing.import_files import import_files

    with shown("importing") as report:
        imported = import_files(items, map_path, progress=report)
    # The report reads the ledger in the folder of the runs.
    _imports.append(imported)
    return imported.rig, imported.runs


def _check(on: Rig, law: str | None) -> None:
    """Raise an InputError if the rig lacks data that the law needs."""
    law = law_of_diagnosis(on, law)
    if law != AUTO:
        check_rig(on, law)


def rig(path: str, law: str | None) -> Rig:
    """Read a rig file and check that it has the data that a law needs.

    The check is omitted if the law is selected from the runs.
    """
    _refuse_csv(path, "RIG")
    try:
        content = read_rig(path)
        _check(content, law)
    except InputError as error:
        if {"law", "format", "effects"} & _keys(path):
            raise InputError(
                file=path,
                problem="is a model file, not a rig",
                remedy=(
                    "name the rig's TOML with [bearing], [lubricant] and [load], or with [drive]"
                ),
            ) from None
        raise error.within(file=path) from None
    return content


def model(path: str) -> Model:
    """Read a model file."""
    _refuse_csv(path, "MODEL")
    try:
        return Model.load(path)
    except InputError:
        keys = _keys(path)
        if keys & _RIG_SECTIONS and "law" not in keys:
            raise InputError(
                file=path,
                problem="is a rig, not a model file",
                remedy=f"make a model first: jbf fit {path} RUN... --out model.toml",
            ) from None
        raise


def runs(items: Sequence[str], on: Rig, *, first: str) -> list[Run]:
    """Read the runs of a rig from files, folders and patterns.

    `first` is the argument before the runs, for error messages.
    """
    for item in items:
        _refuse_toml(item, first)
    return read_runs(items, on)


def motion(item: str, on: Rig) -> Run:
    """Read one run of a rig, which need not contain friction."""
    _refuse_toml(item, "MODEL")
    try:
        return read_run(item, on, need_friction=False)
    except InputError as error:
        if error.column is None:
            raise
        first = f"import it first: jbf import {item} --map map.toml --folder NAME"
        raise InputError(
            file=error.file,
            row=error.row,
            column=error.column,
            key=error.key,
            problem=error.problem,
            remedy=f"{error.remedy}; or, if this is a recording as logged, {first}",
        ) from None


def _keys(path: str) -> set[str]:
    """Top-level keys of a TOML file; empty for any other file."""
    try:
        return set(read_toml(path))
    except InputError:
        return set()


def _refuse_csv(path: str, argument: str) -> None:
    if Path(path).suffix.lower() == ".csv":
        raise InputError(
            file=path,
            problem=f"is a CSV file where {argument} should be",
            remedy=f"name the TOML file first, then the runs: {argument} RUN...",
        )


def _refuse_toml(path: str, first: str) -> None:
    if Path(path).suffix.lower() == ".toml":
        raise InputError(
            file=path,
            problem="is a TOML file where a run should be",
            remedy=f"name one {first} and then CSV files",
        )
