"""Reading a run from CSV.

Each column is first converted to numbers as a whole. Only if this conversion fails, the invalid
cell is located, so that the error names row and column. A valid file is read in milliseconds.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jbf.arrays import Array, Mask
from jbf.errors import InputError, closest, quoted
from jbf.records.arguments import the_rig
from jbf.records.channels import SEPARATE_CLOCK_SHARE, filled
from jbf.records.checks import (
    COLUMNS,
    MIN_SAMPLES,
    MOTION,
    POINT,
    POINT_S,
    SLOW,
    check_columns,
    frozen,
    listed,
)
from jbf.records.counts import count_of
from jbf.records.csv_table import HEADER_EXAMPLE, lines_of, plain_columns, read_table
from jbf.records.drive_columns import ALIASES as DRIVE_ALIASES
from jbf.records.drive_columns import DriveColumns
from jbf.records.other_units import in_other_units, unread_columns
from jbf.records.rig import Rig
from jbf.records.run import PathLike, Run
from jbf.text_files import name_of, path_of

DRIVE_COLUMNS = (
    "torque_n_m",
    "motor_torque_n_m",
    "current_a",
    "torque_percent",
    "force_percent",
    "voltage_v",
    "load_n_m",
    "weight_angle_rad",
    "velocity_rad_s",
    "speed_rpm",
    "motor_angle_rad",
    "motor_velocity_rad_s",
    "motor_speed_rpm",
)
"""Columns that can be interpreted only with a rig that has a drive."""
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
"""Common alternative names of columns, used only for suggestions."""


def _near_miss(
    word: str, absent: Iterable[str], aliases: Mapping[str, str] = _ALIASES
) -> str | None:
    """Return the absent column that `word` is probably a misspelling of, or None.

    A word with more parts than the column (``position_ref_m``) is treated as a different quantity.
    """
    absent = list(absent)
    alias = aliases.get(word.lower())
    if alias in absent:
        return alias
    shorter = [c for c in absent if word.count("_") <= c.count("_")]
    return closest(word, shorter, 0.7)


def _checked_header(
    path: Path,
    row: int,
    header: Sequence[str],
    required: Sequence[str],
    of_drive: DriveColumns | None,
) -> None:
    known_columns = COLUMNS if of_drive is None else of_drive.known

    def wrong(column: str | None, problem: str, remedy: str) -> InputError:
        return InputError(file=path, row=row, column=column, problem=problem, remedy=remedy)

    if all(_is_number(cell) for cell in header):
        raise wrong(
            None,
            "has numbers where the header should be",
            f"put a line with the column names first, without #: {HEADER_EXAMPLE}",
        )
    if len(header) == 1 and len(header[0].split()) > 1:
        raise wrong(None, "the names are separated by blanks", "separate the cells with commas")
    for name in header:
        if name and header.count(name) > 1:
            raise wrong(name, "is in the header twice", "keep one and rename or remove the other")
    # The file of a drive has many other columns, so only the required ones are checked there.
    absent = [name for name in (COLUMNS if of_drive is None else required) if name not in header]
    aliases = _ALIASES if of_drive is None else _ALIASES | DRIVE_ALIASES
    misses = {
        miss: name
        for name in header
        if name not in known_columns and (miss := _near_miss(name, absent, aliases)) is not None
    }
    for name in required:
        if name in absent:
            if name in misses:
                remedy = f"did you mean {quoted(misses[name])}? rename it to {name}"
            else:
                remedy = f"add it; the header has {listed(header)}"
                columns = (name,) if of_drive is None else of_drive.alternatives(name)
                for other, unit in [*in_other_units(header, columns)][:1]:
                    remedy = f"{other} is in {unit}; jbf import converts it"
                of_drives = [heading for heading in DRIVE_COLUMNS if heading in header]
                if of_drive is None and of_drives:
                    remedy += f"; a rig with [drive] defines {of_drives[0]}"
            raise wrong(name, "is missing", remedy)
    for name, near_miss in misses.items():
        raise wrong(
            near_miss,
            "is not a known column",
            f"did you mean {quoted(name)}? rename it (mind the unit) or give it another name",
        )


def _is_number(cell: str) -> bool:
    """Whether a cell is a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _bad_cell(path: Path, row: int, column: str, cell: str) -> InputError:
    if not cell.strip():
        problem, remedy = "the cell is empty", "fill it or remove the row"
    elif re.fullmatch(r"\s*[+-]?\d*,\d+(e[+-]?\d+)?\s*", cell, re.IGNORECASE):
        problem = f"{quoted(cell.strip())} has a decimal comma"
        remedy = "write every number with a decimal point"
    else:
        problem = f"{quoted(cell.strip())} is not a number"
        remedy = "correct the cell or remove the row"
    return InputError(file=path, row=row, column=column, problem=problem, remedy=remedy)


def read_run(path: PathLike, rig: Rig | None = None, *, need_friction: bool = True) -> Run:
    """Read one run from CSV.

    The header names the columns. ``time_s``, ``friction_n`` and a motion (``velocity_m_s``, or
    ``position_m``, or ``angle_rad`` and a rig with a bearing) are required; the other `COLUMNS` are
    optional. Any further column whose cells are all finite numbers is kept in `Run.extra`; any
    other column is ignored. A column with many empty cells is a channel with a separate clock; its
    empty cells are instants at which the channel was not sampled. The column ``point`` in place of
    ``time_s`` numbers steady states, as in a Stribeck curve. Cells are separated by commas,
    semicolons or tabs. Blank lines, and lines before the header that start with ``#``, are skipped.

    Parameters
    ----------
    path : path
        The file.
    rig : Rig, optional
        The rig of the recording. Its drive, if it has one, defines which columns hold friction and
        motion (``docs/drives.md``) and how they are converted.
    need_friction : bool
        False allows ``friction_n`` to be absent, as in a motion for a prediction.

    Returns
    -------
    Run
        The checked columns; the name of the run is the stem of the file name.

    Raises
    ------
    InputError
        The file or a cell of it is invalid; the message names file, row, column and remedy.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> len(jbf.read_run("sweep.csv"))
    20
    """
    path = path_of(path)
    name_of_run = name_of(path)
    lines, first, delimiter = lines_of(path)
    plain = plain_columns(lines, first, delimiter)
    rows: list[list[str]] = []
    numbers: Sequence[int] = range(first + 2, len(lines) + 1)
    if plain is None:
        (names, *rows), (_, *numbers) = read_table(path, lines, first, delimiter)
    else:
        names = lines[first].split(delimiter)
    header = [name.strip() for name in names]
    drive = None if rig is None else the_rig(rig).drive
    of_drive = None if drive is None else DriveColumns.of(drive)
    if of_drive is not None:
        of_drive.refuse_foreign_columns(path, first + 1, header)
        required = of_drive.required(header, need_friction)
    else:
        required = _required(header, need_friction)
    known_columns = COLUMNS if of_drive is None else of_drive.known
    steady = POINT in header and "time_s" not in header
    if steady:
        required = [POINT if name == "time_s" else name for name in required]
    _checked_header(path, first + 1, header, required, of_drive)
    columns: dict[str, Array] = {}
    gaps: dict[str, Mask] = {}
    if plain is None:
        columns, gaps = _converted(path, header, rows, numbers, known_columns)
    else:
        columns = {name: frozen(v) for name, v in zip(header, plain, strict=True) if name}
    if steady and POINT in columns:
        speeds = ("velocity_m_s",) if of_drive is None else tuple(of_drive.speed)
        columns = _by_speed(columns, next((s for s in speeds if s in columns), POINT))
    check_columns(name_of_run, columns, path, numbers, known_columns)
    for name, sampled in gaps.items():
        columns[name] = filled(columns["time_s"], columns[name], sampled)
    if of_drive is None:
        return replace(Run.of_columns(name_of_run, columns, path), read=gaps)
    unread = unread_columns(name_of_run, columns, of_drive.quantities)
    called = of_drive.called(columns)
    columns, findings = of_drive.converted(name_of_run, columns)
    run = Run.of_columns(name_of_run, columns, path)
    findings = (*unread, *findings, *run.reading)
    read = {called.get(name, name): sampled for name, sampled in gaps.items()}
    read = {name: sampled for name, sampled in read.items() if name in columns}
    return replace(run, quantities=of_drive.drive.quantities, reading=findings, read=read)


def _converted(
    path: Path,
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    numbers: Sequence[int],
    known_columns: Collection[str],
) -> tuple[dict[str, Array], dict[str, Mask]]:
    """Convert cells to columns of numbers, and find the gaps of channels with separate clocks."""
    if not rows:
        raise InputError(file=path, problem="has a header but no samples", remedy="add the samples")
    if set(map(len, rows)) != {len(header)}:
        at = next(i for i, cells in enumerate(rows) if len(cells) != len(header))
        raise InputError(
            file=path,
            row=numbers[at],
            problem=f"has {count_of(len(rows[at]), 'cell')} where the header has {len(header)}",
            remedy="give every row one cell per column, with a decimal point",
        )
    columns: dict[str, Array] = {}
    gaps: dict[str, Mask] = {}
    turned = list(zip(*rows, strict=True))
    for name, cells in zip(header, turned, strict=True):
        if name == SLOW:
            cells = tuple(cell if cell.strip() else "nan" for cell in cells)
            if all(cell == "nan" for cell in cells):
                continue
        try:
            values = frozen(list(map(float, cells)))
        except ValueError:
            channel = None if name == "time_s" else _separately_clocked(cells, turned)
            if channel is not None and name:
                columns[name], gaps[name] = channel
            elif name in known_columns:
                at = next(i for i, cell in enumerate(cells) if not _is_number(cell))
                raise _bad_cell(path, numbers[at], name, cells[at]) from None
            continue
        if name in known_columns or (name and np.isfinite(values).all()):
            columns[name] = values
    return columns, gaps


def _by_speed(columns: Mapping[str, Array], speed: str) -> dict[str, Array]:
    """Sort steady states by speed and give them a nominal time axis.

    The differences between adjacent samples are then mostly noise, regardless of the order in which
    the states were measured.
    """
    order = np.argsort(columns[speed], kind="stable")
    ordered = {name: frozen(values[order]) for name, values in columns.items()}
    return ordered | {"time_s": frozen(POINT_S * np.arange(len(order)))}


def _separately_clocked(
    cells: Sequence[str], other_columns: Sequence[Sequence[str]]
) -> tuple[Array, Mask] | None:
    """Return the readings of a channel with a separate clock, and the mask of its non-empty cells.

    Returns None if a cell is not a number, or if the share of empty cells is below
    `SEPARATE_CLOCK_SHARE`. A fast channel may have a smaller share; every row without a value of it
    must then have a value of a slower channel.
    """
    sampled = _filled_cells(cells)
    if not sampled.any():
        return None
    if not _is_a_clock(sampled):
        clock_masks = [mask for mask in map(_filled_cells, other_columns) if _is_a_clock(mask)]
        if not clock_masks or not np.logical_or.reduce(clock_masks)[~sampled].all():
            return None
    try:
        read = [float(cell) for cell in cells if cell.strip()]
    except ValueError:
        return None
    values = np.zeros(len(cells))
    values[sampled] = read
    return frozen(values), sampled


def _filled_cells(cells: Sequence[str]) -> Mask:
    """Mask of the non-empty cells of a column."""
    return np.array([bool(cell.strip()) for cell in cells])


def _is_a_clock(sampled: Mask) -> bool:
    return int(np.count_nonzero(~sampled)) >= max(MIN_SAMPLES, SEPARATE_CLOCK_SHARE * len(sampled))


def _required(header: Sequence[str], need_friction: bool) -> list[str]:
    """Names of the required columns of a file for a rig without a drive."""
    # The first motion column in the header suffices; without any, the speed is reported as missing.
    motion = next((column for column in MOTION if column in header), MOTION[0])
    if any(_near_miss(name, MOTION[:1]) for name in header):
        motion = MOTION[0]
    return ["time_s", motion] + (["friction_n"] if need_friction else [])
