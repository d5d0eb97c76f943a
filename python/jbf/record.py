"""A recorded run: one CSV file, checked, as arrays.

Reading tries each column as numbers at once and looks for the bad cell only when that fails, so a
good file costs a few milliseconds and a bad one still gets its row and column named.
"""

from __future__ import annotations

import csv
import glob
import io
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError, closest, quoted, read_text, write_text

Array = npt.NDArray[np.float64]
PathLike = str | os.PathLike[str]

MIN_SAMPLES = 10
COLUMNS = (
    "time_s",
    "angle_rad",
    "position_m",
    "velocity_m_s",
    "friction_n",
    "load_n",
    "temperature_c",
)
"""Columns with a meaning, in the order in which `Run.write_csv` writes them."""


@dataclass(frozen=True, eq=False, repr=False)
class Run:
    """One recorded run; every array has shape (N,), is float64 and read-only.

    The constructor trusts its arguments; `Run.from_arrays` and `read_run` check them.

    Attributes
    ----------
    name : str
        What reports call the run.
    time_s : ndarray
        Time, strictly increasing, s.
    velocity_m_s : ndarray
        Signed surface speed, m/s.
    friction_n : ndarray or None
        Tangential friction force of one bearing, N.
    angle_rad, position_m : ndarray or None
        Where the journal (rad) or the slider (m) is.
    load_n : ndarray or None
        Normal load on one bearing, above zero, N.
    temperature_c : ndarray or None
        Temperature, degrees Celsius.
    extra : dict of str to ndarray
        The other numeric columns, units as their names say.
    path : Path or None
        The file it came from.
    """

    name: str
    time_s: Array
    velocity_m_s: Array
    friction_n: Array | None = None
    angle_rad: Array | None = None
    position_m: Array | None = None
    load_n: Array | None = None
    temperature_c: Array | None = None
    extra: dict[str, Array] = field(default_factory=dict)
    path: Path | None = None

    def __repr__(self) -> str:
        there = ", ".join(self.columns())
        return f"Run({self.name!r}, {len(self)} samples, {self.duration_s:g} s: {there})"

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample, s; zero for an empty selection."""
        return float(self.time_s[-1] - self.time_s[0]) if len(self) else 0.0

    def columns(self) -> dict[str, Array]:
        """The arrays that are there, by column name: known ones first, then `extra`."""
        known = {name: getattr(self, name) for name in COLUMNS}
        return {name: a for name, a in known.items() if a is not None} | self.extra

    def select(self, which: slice | npt.ArrayLike) -> Run:
        """The samples that a slice or a boolean mask of shape (N,) keeps, as a run.

        A selection may be shorter than `MIN_SAMPLES`, and a mask may leave gaps in time.

        Raises
        ------
        InputError
            The mask is not boolean or not of shape (N,), or the slice runs backwards.
        """
        if isinstance(which, slice):
            if which.step is not None and which.step < 1:
                raise InputError(
                    file=self.name,
                    problem="a selection cannot run backwards",
                    mend="use a step > 0",
                )
            index: Any = which
        else:
            index = np.asarray(which)
            if index.dtype != np.bool_ or index.shape != (len(self),):
                raise InputError(
                    file=self.name,
                    problem=f"a mask of {index.dtype} and shape {index.shape} cannot select",
                    mend=f"give a slice or a boolean mask of shape ({len(self)},)",
                )
        kept = {name: _frozen(a[index]) for name, a in self.columns().items()}
        extra = {name: kept.pop(name) for name in self.extra}
        return replace(self, **kept, extra=extra)  # type: ignore[arg-type]

    @classmethod
    def from_arrays(
        cls,
        time_s: npt.ArrayLike,
        velocity_m_s: npt.ArrayLike,
        friction_n: npt.ArrayLike | None = None,
        *,
        angle_rad: npt.ArrayLike | None = None,
        position_m: npt.ArrayLike | None = None,
        load_n: npt.ArrayLike | None = None,
        temperature_c: npt.ArrayLike | None = None,
        extra: Mapping[str, npt.ArrayLike] | None = None,
        name: str = "run",
        path: PathLike | None = None,
    ) -> Run:
        """A run from lists, arrays or pandas series of one length N, copied and checked.

        Raises
        ------
        InputError
            A column is not N finite numbers, N < `MIN_SAMPLES`, time does not increase, or a
            load is not above zero. Samples are counted from 0.
        """
        given: dict[str, npt.ArrayLike | None] = {
            "time_s": time_s,
            "angle_rad": angle_rad,
            "position_m": position_m,
            "velocity_m_s": velocity_m_s,
            "friction_n": friction_n,
            "load_n": load_n,
            "temperature_c": temperature_c,
        }
        for column in extra or {}:
            if column in given:
                raise InputError(
                    file=name,
                    column=column,
                    problem="is a known column, not an extra one",
                    mend="pass it as its own argument",
                )
        columns = {
            column: _as_array(values, column, name)
            for column, values in (given | dict(extra or {})).items()
            if values is not None
        }
        return _checked_run(name, columns, None if path is None else Path(path), None)

    def write_csv(self, path: PathLike) -> None:
        """Write the run as CSV, whole or not at all; reading it gives the same bits.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, self.to_csv())

    def to_csv(self) -> str:
        """The run as the text of a CSV file."""
        columns = self.columns()
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        # repr of a float is the shortest text that reads back to the same bits.
        writer.writerows(zip(*(map(repr, a.tolist()) for a in columns.values()), strict=True))
        return text.getvalue()


def require(run: Run, columns: str | Iterable[str], why: str) -> None:
    """Raise the one-line error when a run lacks a column that someone needs.

    Parameters
    ----------
    columns : str or iterable of str
        Column names, for example ``"angle_rad"``.
    why : str
        Who needs it, as a subject: ``"the effect position_ripple"``.

    Raises
    ------
    InputError
        A column is missing.
    """
    there = run.columns()
    for column in [columns] if isinstance(columns, str) else columns:
        if column not in there:
            raise InputError(
                file=run.path or run.name,
                column=column,
                problem=f"is missing, and {why} needs it",
                mend=f"add the column (it has {_listed(there)})",
            )


def _listed(names: Iterable[str]) -> str:
    return shorten(", ".join(name for name in names if name), 160, placeholder=" ...")


# ---- the checks that arrays and files share -------------------------------------------------


def _frozen(values: npt.ArrayLike) -> Array:
    array = np.array(values, dtype=np.float64, order="C")
    array.flags.writeable = False
    return array


def _as_array(values: npt.ArrayLike, column: str, name: str) -> Array:
    def wrong(problem: str) -> InputError:
        return InputError(
            file=name, column=column, problem=problem, mend="give one number a sample, shape (N,)"
        )

    try:
        array = np.asarray(values)
        # Text, dates and complex numbers would convert to something nobody meant.
        if array.dtype.kind not in "biufO":
            raise wrong(f"holds {array.dtype}, not numbers")
        array = _frozen(array)
    except InputError:
        raise
    except (TypeError, ValueError, OverflowError):
        raise wrong("is not an array of numbers") from None
    if array.ndim != 1:
        raise wrong(f"has shape {array.shape}")
    return array


def _checked_run(
    name: str, columns: Mapping[str, Array], path: Path | None, rows: Sequence[int] | None
) -> Run:
    """A run of columns that hold what their names promise; `rows` are the samples' lines."""
    file = path if rows is not None and path is not None else name

    def wrong(column: str, index: int, problem: str, mend: str) -> InputError:
        if rows is None:
            return InputError(
                file=file, column=column, problem=f"sample {index}: {problem}", mend=mend
            )
        return InputError(file=file, row=rows[index], column=column, problem=problem, mend=mend)

    samples = len(columns["time_s"])
    if samples < MIN_SAMPLES:
        raise InputError(
            file=file,
            problem=f"has {samples} samples",
            mend=f"a run needs at least {MIN_SAMPLES}",
        )
    for column, values in columns.items():
        if len(values) != samples:
            raise InputError(
                file=file,
                column=column,
                problem=f"has {len(values)} samples where time_s has {samples}",
                mend="give every column one value a sample",
            )
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size:
            raise wrong(
                column,
                int(bad[0]),
                f"{values[bad[0]]} is not a finite number",
                "correct the cell or drop the row",
            )
    time_s = columns["time_s"]
    bad = np.flatnonzero(np.diff(time_s) <= 0.0)
    if bad.size:
        before, now = float(time_s[bad[0]]), float(time_s[bad[0] + 1])
        raise wrong(
            "time_s",
            int(bad[0]) + 1,
            f"time repeats at {now}" if now == before else f"time runs back from {before} to {now}",
            "sort the rows and drop repeats; one file is one run",
        )
    if "load_n" in columns:
        bad = np.flatnonzero(columns["load_n"] <= 0.0)
        if bad.size:
            raise wrong(
                "load_n",
                int(bad[0]),
                f"a load of {columns['load_n'][bad[0]]} N is not above zero",
                "correct the cell or drop the row",
            )
    known = {column: values for column, values in columns.items() if column in COLUMNS}
    extra = {column: values for column, values in columns.items() if column not in COLUMNS}
    return Run(name=name, **known, extra=extra, path=path)


# ---- CSV ------------------------------------------------------------------------------------

_HEADER_EXAMPLE = "time_s,velocity_m_s,friction_n"
_ALIASES = {
    "t": "time_s",
    "seconds": "time_s",
    "v": "velocity_m_s",
    "speed": "velocity_m_s",
    "speed_m_s": "velocity_m_s",
    "force": "friction_n",
    "force_n": "friction_n",
    "friction_force": "friction_n",
    "temp_c": "temperature_c",
    "theta": "angle_rad",
    "theta_rad": "angle_rad",
    "normal_n": "load_n",
    "normal_load_n": "load_n",
}
"""Other names that people give a column, for the suggestion only."""


def _near_miss(word: str, absent: Iterable[str]) -> str | None:
    """The absent column that `word` looks like a slip of.

    A word of more parts than the column (``position_ref_m``) is a quantity of its own.
    """
    absent = list(absent)
    alias = _ALIASES.get(word.lower())
    if alias in absent:
        return alias
    shorter = [c for c in absent if word.count("_") <= c.count("_")]
    return closest(word, shorter, 0.7)


def _checked_header(path: Path, row: int, header: Sequence[str], required: Sequence[str]) -> None:
    def wrong(column: str | None, problem: str, mend: str) -> InputError:
        return InputError(file=path, row=row, column=column, problem=problem, mend=mend)

    if all(_is_number(cell) for cell in header):
        raise wrong(
            None,
            "holds numbers where the header should be",
            f"put a line with the column names first, without #: {_HEADER_EXAMPLE}",
        )
    if len(header) == 1 and len(header[0].split()) > 1:
        raise wrong(None, "the names are parted by blanks", "part the cells with commas")
    for name in header:
        if name and header.count(name) > 1:
            raise wrong(name, "stands twice in the header", "keep one and rename or drop the other")
    absent = [name for name in COLUMNS if name not in header]
    misses = {
        miss: name
        for name in header
        if name not in COLUMNS and (miss := _near_miss(name, absent)) is not None
    }
    for name in required:
        if name in absent:
            if name in misses:
                mend = f"did you mean {quoted(misses[name])}? rename it to {name}"
            else:
                mend = f"add it; the header has {_listed(header)}"
            raise wrong(name, "is missing", mend)
    for name, found in misses.items():
        raise wrong(
            found,
            "is not a known column",
            f"did you mean {quoted(name)}? rename it (mind the unit) or give it another name",
        )


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _bad_cell(path: Path, row: int, column: str, cell: str) -> InputError:
    if not cell.strip():
        problem, mend = "the cell is empty", "fill it or drop the row"
    elif re.fullmatch(r"\s*[+-]?\d*,\d+(e[+-]?\d+)?\s*", cell, re.IGNORECASE):
        problem = f"{quoted(cell.strip())} has a decimal comma"
        mend = "write every number with a decimal point"
    else:
        problem = f"{quoted(cell.strip())} is not a number"
        mend = "correct the cell or drop the row"
    return InputError(file=path, row=row, column=column, problem=problem, mend=mend)


def _read_table(path: Path) -> tuple[list[str], int, list[list[str]], list[int]]:
    """Header, its line, the rows of cells, and the line of each row; blank lines are skipped."""
    # Universal newlines, and no other character that str.splitlines would take for one.
    lines = list(io.StringIO(read_text(path), newline=None))
    first = 0
    while first < len(lines) and (
        not lines[first].strip() or lines[first].lstrip().startswith("#")
    ):
        first += 1
    if first == len(lines):
        raise InputError(
            file=path, problem="is empty", mend=f"start with a header such as {_HEADER_EXAMPLE}"
        )
    reader = csv.reader(lines[first:], delimiter=max(",;\t", key=lines[first].count))
    records: list[list[str]] = []
    numbers: list[int] = []
    line = first
    try:
        for cells in reader:
            line += 1
            if first + reader.line_num > line:
                raise csv.Error("a quote is not closed")
            if cells:
                records.append(cells)
                numbers.append(line)
    except csv.Error as error:
        raise InputError(
            file=path, row=line, problem=str(error), mend="correct the row; one line is one row"
        ) from None
    header = [name.strip() for name in records[0]]
    return header, numbers[0], records[1:], numbers[1:]


def read_run(path: PathLike, *, need_friction: bool = True) -> Run:
    """Read one run from CSV.

    The header names the columns; ``time_s``, ``velocity_m_s`` and ``friction_n`` must be there,
    the other `COLUMNS` may be. Any further column whose cells are all finite numbers is kept in
    `Run.extra`, any other is ignored. Comma, semicolon or tab part the cells; blank lines, and
    lines before the header that start with ``#``, are skipped.

    Parameters
    ----------
    path : path
        The file.
    need_friction : bool
        False lets ``friction_n`` be absent, as in a motion to predict for.

    Raises
    ------
    InputError
        The file or a cell of it is wrong; the message names file, row, column and the mend.
    """
    path = Path(path)
    header, header_row, rows, numbers = _read_table(path)
    required = ["time_s", "velocity_m_s"] + (["friction_n"] if need_friction else [])
    _checked_header(path, header_row, header, required)
    if not rows:
        raise InputError(file=path, problem="has a header but no samples", mend="add the samples")
    if set(map(len, rows)) != {len(header)}:
        at = next(i for i, cells in enumerate(rows) if len(cells) != len(header))
        raise InputError(
            file=path,
            row=numbers[at],
            problem=f"has {len(rows[at])} cells where the header has {len(header)}",
            mend="give every row one cell a column, numbers with a decimal point",
        )
    columns: dict[str, Array] = {}
    for name, cells in zip(header, zip(*rows, strict=True), strict=True):
        try:
            values = _frozen(list(map(float, cells)))
        except ValueError:
            if name in COLUMNS:
                at = next(i for i, cell in enumerate(cells) if not _is_number(cell))
                raise _bad_cell(path, numbers[at], name, cells[at]) from None
            continue
        if name in COLUMNS or (name and np.isfinite(values).all()):
            columns[name] = values
    return _checked_run(path.stem, columns, path, numbers)


def _expanded(item: PathLike) -> list[Path]:
    path = Path(item)
    if path.is_dir():
        found = sorted(p for p in path.iterdir() if p.suffix.lower() == ".csv")
        if not found:
            raise InputError(
                file=path, problem="the folder holds no .csv file", mend="name another"
            )
        return found
    if not path.exists() and glob.has_magic(str(path)):
        found = sorted(Path(p) for p in glob.glob(str(path), recursive=True) if Path(p).is_file())
        if not found:
            raise InputError(file=path, problem="no file matches", mend="correct the pattern")
        return found
    return [path]


def _unique_names(paths: Sequence[Path]) -> list[str]:
    """The stem of each path, with as many parent folders as tell equal stems apart."""
    whole = [path.resolve() for path in paths]

    def name(path: Path, depth: int) -> str:
        return "/".join(path.with_suffix("").parts[-depth:])

    names = []
    for path in whole:
        rivals = [p for p in whole if p.stem == path.stem and p != path]
        depth = 1
        while depth < len(path.parts) and name(path, depth) in {name(p, depth) for p in rivals}:
            depth += 1
        clash = name(path, depth) in {name(p, depth) for p in rivals}
        names.append(path.name if clash else name(path, depth))
    return names


def read_runs(paths: PathLike | Iterable[PathLike], *, need_friction: bool = True) -> list[Run]:
    """Read runs from files, folders (every .csv in it, sorted) and glob patterns.

    Names are the file stems; runs with equal stems get parent folders too: ``a/sweep``.

    Raises
    ------
    InputError
        As `read_run`; also when nothing is found or a file comes twice.
    """
    items = [paths] if isinstance(paths, str | os.PathLike) else list(paths)
    files = [file for item in items for file in _expanded(item)]
    if not files:
        raise InputError(problem="no run is given", mend="name at least one CSV file or folder")
    seen: set[Path] = set()
    for file in files:
        if file.resolve() in seen:
            raise InputError(file=file, problem="is given twice", mend="name each run once")
        seen.add(file.resolve())
    runs = [read_run(file, need_friction=need_friction) for file in files]
    return [replace(run, name=name) for run, name in zip(runs, _unique_names(files), strict=True)]
