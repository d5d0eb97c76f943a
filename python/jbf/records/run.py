"""Recorded run, with checked columns as arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from jbf.arrays import Array, Mask
from jbf.errors import InputError
from jbf.records.channels import Channels, recorded_samples, side_by_side
from jbf.records.checks import (
    ATTRIBUTES,
    COLUMNS,
    MOTION,
    POINT,
    SLOW,
    UNITS,
    as_array,
    attribute,
    check_columns,
    frozen,
    listed,
    selection,
    unwrapped,
)
from jbf.records.csv_output import csv_of_columns
from jbf.records.derived_columns import derived_speed_column, fill_gaps
from jbf.records.findings.finding import Finding
from jbf.records.frames import columns_of, columns_of_dataset, dataset_of_columns
from jbf.records.quantities import BEARING, Quantities
from jbf.results import Shown, data_frame
from jbf.text_files import write_text

PathLike = str | os.PathLike[str]


@dataclass(frozen=True, eq=False, repr=False)
class Run(Shown):
    """One recorded run; every array has shape (N,), is float64 and read-only.

    The constructor does not check its arguments; `Run.from_arrays` and `read_run` do.

    Attributes
    ----------
    name : str
        Name of the run in reports.
    time_s : ndarray
        Time, strictly increasing, s.
    velocity : ndarray
        Signed surface speed, m/s; nan if only an angle was recorded.
    friction : ndarray or None
        Tangential friction force of one bearing, N.
    angle_rad, position_m : ndarray or None
        Angle of the journal, rad, or position of the slider, m.
    load_n : ndarray or None
        Normal load on one bearing, above zero, N.
    temperature_c : ndarray or None
        Temperature, degrees Celsius; linearly interpolated if it was sampled more slowly.
    extra : dict of str to ndarray
        The other numeric columns, in the units of their names.
    path : Path or None
        The file that the run was read from.
    speed_recorded : bool
        False if the speed is only a difference of the position, or follows from the angle.
    quantities : Quantities
        Units and words; those of a rotary drive have N m in place of N and rad in place of m.
    reading : tuple of Finding
        Conversions that were made when the run was read.
    read : dict of str to ndarray
        Mask of the instants at which a channel with a separate clock was sampled, bool, shape (N,).
        At the other instants, the array of the channel is linearly interpolated. A column without
        a mask was sampled at every instant.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 4.0, 0.02)
    >>> v = 0.1 * np.sin(3.0 * t)
    >>> run = jbf.Run.from_arrays(t, v, 5.0 * np.sign(v) + 20.0 * v, name="sweep")
    >>> len(run), run.duration_s
    (200, 3.98)
    """

    name: str
    time_s: Array
    velocity: Array
    friction: Array | None = None
    angle_rad: Array | None = None
    position_m: Array | None = None
    load_n: Array | None = None
    temperature_c: Array | None = None
    extra: dict[str, Array] = field(default_factory=dict)
    path: Path | None = None
    speed_recorded: bool = True
    quantities: Quantities = BEARING
    reading: tuple[Finding, ...] = ()
    read: dict[str, Mask] = field(default_factory=dict)

    def __repr__(self) -> str:
        column_names = ", ".join(self._called())
        return f"Run({self.name!r}, {len(self)} samples, {self.duration_s:g} s: {column_names})"

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def steady(self) -> bool:
        """Whether each sample is a steady state, as in a Stribeck curve."""
        return POINT in self.extra

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample, s; zero for an empty selection."""
        return float(self.time_s[-1] - self.time_s[0]) if len(self) else 0.0

    def columns(self) -> dict[str, Array]:
        """Arrays that are present, by column name: known columns first, then `extra`."""
        standard = {column: getattr(self, attribute(column)) for column in COLUMNS}
        if not self.speed_recorded:
            del standard["velocity_m_s"]
        return {name: a for name, a in standard.items() if a is not None} | self.extra

    def _called(self) -> dict[str, Array]:
        """Arrays of the run under column names that state their units."""
        called = {
            "friction_n": self.quantities.friction_column,
            "velocity_m_s": self.quantities.speed_column,
        }
        return {called.get(name, name): a for name, a in self.columns().items()}

    def _arrays(self) -> dict[str, Array]:
        """Arrays of the run by column name, always including the speed."""
        return {"velocity_m_s": self.velocity} | self.columns()

    def select(self, which: slice | npt.ArrayLike) -> Run:
        """Return the selected samples as a run; `which` is a slice or a mask of shape (N,).

        A selection may be shorter than `MIN_SAMPLES`, and a mask may leave gaps in time.

        Raises
        ------
        InputError
            The mask is not boolean or not of shape (N,), or the slice runs backwards.
        """
        index = selection(which, len(self), self.name)
        selected = {name: frozen(a[index]) for name, a in self._arrays().items()}
        extra = {name: selected.pop(name) for name in self.extra}
        read = {name: sampled[index] for name, sampled in self.read.items()}
        read = {name: sampled for name, sampled in read.items() if not sampled.all()}
        standard = {attribute(column): values for column, values in selected.items()}
        return replace(self, **standard, extra=extra, read=read)  # type: ignore[arg-type]

    @classmethod
    def from_arrays(
        cls,
        time_s: npt.ArrayLike,
        velocity: npt.ArrayLike | None = None,
        friction: npt.ArrayLike | None = None,
        *,
        angle_rad: npt.ArrayLike | None = None,
        position_m: npt.ArrayLike | None = None,
        load_n: npt.ArrayLike | None = None,
        temperature_c: npt.ArrayLike | None = None,
        extra: Mapping[str, npt.ArrayLike] | None = None,
        name: str = "run",
        path: PathLike | None = None,
        **columns: npt.ArrayLike,
    ) -> Run:
        """Build a run from lists, arrays or pandas series of one length N, copied and checked.

        Without a speed, a position or an angle is required to define the motion. Speed and friction
        are in the units of the rig; the column names ``velocity_m_s`` and ``friction_n`` are
        accepted in place of `velocity` and `friction`, so that the result of `columns` can be
        passed.

        Raises
        ------
        InputError
            A column is not N finite numbers, N < `MIN_SAMPLES`, time does not increase, or a load
            is not above zero. Samples are counted from 0.
        """
        given: dict[str, npt.ArrayLike | None] = {
            "time_s": time_s,
            "angle_rad": angle_rad,
            "position_m": position_m,
            "velocity_m_s": velocity,
            "friction_n": friction,
            "load_n": load_n,
            "temperature_c": temperature_c,
        }
        for column, values in columns.items():
            if column not in ATTRIBUTES:
                raise TypeError(f"from_arrays() got an unexpected argument {column!r}")
            given[column] = values
        for column in extra or {}:
            if column in given:
                raise InputError(
                    file=name,
                    column=column,
                    problem="is a known column, not an extra one",
                    remedy="pass it as its own argument",
                )
        if time_s is None:
            raise InputError(
                file=name, column="time_s", problem="is None", remedy="give the instants, s"
            )
        arrays = {
            column: as_array(values, column, name)
            for column, values in (given | dict(extra or {})).items()
            if values is not None
        }
        if not any(column in arrays for column in MOTION):
            raise InputError(
                file=name,
                column="velocity_m_s",
                problem="is missing, and no position is given",
                remedy=f"give one of {', '.join(MOTION)}",
            )
        check_columns(name, arrays, None, None)
        return cls.of_columns(name, arrays, None if path is None else Path(path))

    @classmethod
    def from_channels(
        cls, channels: Channels, *, name: str = "run", path: PathLike | None = None
    ) -> Run:
        """Build a run from channels with separate clocks, without resampling.

        Parameters
        ----------
        channels
            Column name (``friction_n``, ``angle_rad``, ..., or any other) to its instants, s, and
            its values there, each of shape (n,); n and the instants may differ.

        Raises
        ------
        InputError
            A channel is not finite numbers at increasing instants, or no channel defines the
            motion.
        """
        columns, read = side_by_side(channels, name)
        check_columns(name, columns, None, None)
        run = cls.of_columns(name, columns, None if path is None else Path(path))
        return replace(run, read=read)

    @classmethod
    def from_frame(cls, frame: object, *, name: str = "run", path: PathLike | None = None) -> Run:
        """Build a run from a data frame (pandas, polars), an Arrow table or a mapping of arrays.

        Columns are named as in a file; those that are not numeric are ignored. A column with 5 % or
        more missing values (nan, null) is a channel with a separate clock.

        Raises
        ------
        InputError
            As in `from_arrays`; also if `time_s` is missing.
        """
        columns = columns_of(frame, name)
        time_s = columns.pop("time_s", None)
        if time_s is None:
            raise InputError(
                file=name,
                column="time_s",
                problem="is missing",
                remedy=f"rename a column (it has {listed(columns)})",
            )
        channels = {column: recorded_samples(time_s, values) for column, values in columns.items()}
        if any(len(clock) < len(time_s) for clock, _ in channels.values()):
            return cls.from_channels(channels, name=name, path=path)
        standard: dict[str, Any] = {attribute(c): columns.pop(c) for c in COLUMNS if c in columns}
        return cls.from_arrays(time_s, **standard, extra=columns, name=name, path=path)

    def to_frame(self) -> Any:
        """Return the run as a `pandas.DataFrame`, which `from_frame` reads; pandas is optional.

        Returns
        -------
        pandas.DataFrame
            One row per sample, with the names of `columns`; nan where a channel with its own clock
            was not sampled. `attrs` holds the name of the run and the units of the columns.

        Raises
        ------
        InputError
            pandas is not installed.
        """
        frame = data_frame(self._sampled())
        frame.attrs = {"name": self.name, "units": self.units()}
        return frame

    @classmethod
    def from_xarray(cls, dataset: Any, *, name: str | None = None) -> Run:
        """Build a run from an `xarray.Dataset` with the dimension and coordinate `time_s`.

        Parameters
        ----------
        dataset
            Variables named as in `from_frame`; those of other dimensions are ignored.
        name
            Name of the run. Default: the attribute `name` of the dataset, or "run".

        Raises
        ------
        InputError
            As in `from_frame`.
        """
        columns, recorded_name = columns_of_dataset(dataset)
        return cls.from_frame(columns, name=name or recorded_name)

    def to_xarray(self) -> Any:
        """Return the run as an `xarray.Dataset`, which `from_xarray` reads; xarray is optional.

        Returns
        -------
        xarray.Dataset
            Variables over the coordinate `time_s`, each with its unit in the attribute `units`.

        Raises
        ------
        InputError
            xarray is not installed.
        """
        return dataset_of_columns(self._sampled(), self.units(), self.name)

    def units(self) -> dict[str, str]:
        """Return the units of the known columns that are present, by column name."""
        units = UNITS | {
            "velocity_m_s": self.quantities.speed,
            "friction_n": self.quantities.force,
        }
        return {name: units[name] for name in self.columns() if name in units}

    def _sampled(self) -> dict[str, Array]:
        """Return `columns` with nan at the instants at which a channel was not sampled."""
        return {
            name: np.where(self.read[name], values, np.nan) if name in self.read else values
            for name, values in self.columns().items()
        }

    @classmethod
    def of_columns(cls, name: str, columns: Mapping[str, Array], path: Path | None) -> Run:
        """Build a run from columns that have been checked."""
        recorded = "velocity_m_s" in columns
        if not recorded:
            columns = dict(columns) | {"velocity_m_s": derived_speed_column(columns)}
        reading: tuple[Finding, ...] = ()
        if SLOW in columns:
            interpolated, reading = fill_gaps(name, columns["time_s"], columns[SLOW])
            columns = dict(columns) | {SLOW: interpolated}
        standard: dict[str, Any] = {attribute(c): v for c, v in columns.items() if c in COLUMNS}
        extra = {column: values for column, values in columns.items() if column not in COLUMNS}
        return cls(
            name=name,
            **standard,
            extra=extra,
            path=path,
            speed_recorded=recorded,
            reading=reading,
        )

    def at(self, time_s: Array, friction: Array) -> Run:
        """Interpolate the run to other instants within it, with given friction there, N.

        All other columns are interpolated linearly; angles that restart at each turn are unwrapped.
        """
        interpolated = {
            attribute(name): frozen(np.interp(time_s, self.time_s, unwrapped(name, values)))
            for name, values in self._arrays().items()
            if name not in ("time_s", "friction_n")
        }
        extra = {name: interpolated.pop(name) for name in self.extra}
        return replace(
            self,
            time_s=frozen(time_s),
            friction=frozen(friction),
            **interpolated,  # type: ignore[arg-type]
            extra=extra,
            read={},
        )

    def write_csv(self, path: PathLike) -> None:
        """Write the run as CSV, atomically; reading the file gives bitwise equal values.

        Raises
        ------
        InputError
            The file cannot be written.
        """
        write_text(path, self.to_csv())

    def to_csv(self) -> str:
        """Return the run as CSV text, with columns in the units of their names."""
        names = zip(self._called(), self.columns(), strict=True)
        return csv_of_columns(self._called(), {called: self.read.get(key) for called, key in names})
