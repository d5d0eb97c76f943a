"""Reading runs from files, folders and glob patterns, each under a unique name."""

from __future__ import annotations

import glob
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from jbf.errors import InputError
from jbf.records.csv_file import read_run
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run
from jbf.text_files import name_of, path_of, real_path


def _expanded(item: PathLike) -> list[Path]:
    path = Path(item)
    if os.path.isdir(path):
        files = sorted(p for p in path.iterdir() if p.suffix.lower() == ".csv")
        if not files:
            raise InputError(
                file=path, problem="the folder contains no .csv file", remedy="name another folder"
            )
        return files
    if not os.path.lexists(path) and glob.has_magic(str(path)):
        files = sorted(Path(p) for p in glob.glob(str(path), recursive=True) if Path(p).is_file())
        if not files:
            raise InputError(file=path, problem="no file matches", remedy="correct the pattern")
        return files
    return [path]


def _unique_names(paths: Sequence[Path]) -> list[str]:
    """Return the stem of each path, with as many parent folders as distinguish equal stems."""
    real_paths = [real_path(path) for path in paths]

    def name(path: Path, depth: int) -> str:
        return name_of(path, depth)

    names = []
    for path in real_paths:
        rivals = [p for p in real_paths if p.stem == path.stem and p != path]
        depth = 1
        while depth < len(path.parts) and name(path, depth) in {name(p, depth) for p in rivals}:
            depth += 1
        clash = name(path, depth) in {name(p, depth) for p in rivals}
        names.append(path.name if clash else name(path, depth))
    return names


def read_runs(
    paths: PathLike | Iterable[PathLike], rig: Rig | None = None, *, need_friction: bool = True
) -> list[Run]:
    """Read runs from files, folders (every .csv in it, sorted) and glob patterns.

    A rig with a drive defines the meaning of the columns, as in `read_run`.

    Names are the file stems; runs with equal stems are prefixed by parent folders: ``a/sweep``.

    Parameters
    ----------
    paths : path or iterable of path
        Files, folders and glob patterns.
    rig : Rig, optional
        The rig of the recordings.
    need_friction : bool
        False allows the friction to be absent.

    Returns
    -------
    list of Run
        One run per file, in the order of the paths.

    Raises
    ------
    InputError
        As in `read_run`; also if no file is found or a file is given twice.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> [run.name for run in jbf.read_runs("*.csv")]
    ['sweep']
    """
    if isinstance(paths, str | os.PathLike) or not isinstance(paths, Iterable):
        items = [path_of(paths)]
    else:
        items = list(map(path_of, paths))
    files = [file for item in items for file in _expanded(item)]
    if not files:
        raise InputError(problem="no run is given", remedy="name at least one CSV file or folder")
    read_files: set[Path] = set()
    for file in files:
        if real_path(file) in read_files:
            raise InputError(file=file, problem="is given twice", remedy="name each run once")
        read_files.add(real_path(file))
    runs = [read_run(file, rig, need_friction=need_friction) for file in files]
    return [_named(run, name) for run, name in zip(runs, _unique_names(files), strict=True)]


def _named(run: Run, name: str) -> Run:
    return replace(run, name=name, reading=tuple(replace(f, run=name) for f in run.reading))
