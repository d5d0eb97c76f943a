"""The map (`map.toml`): expressions over file columns for the columns of a run, and the rig.

[file]      options for reading the file, if not detected; further files of the recording
[columns]   column of a run = "expression over the file's columns"
[clocks]    column of a run = "expression of its time", if the time is not time_s
[align]     further file = "common signal" or seconds
[cut]       settings for cutting a recording into runs
[drive] or [bearing], [lubricant], [load]   as in rig.toml
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from pathlib import Path
from typing import Any

from jbf.errors import InputError
from jbf.importing.cutting.settings import CutSettings
from jbf.importing.expression import OPEN
from jbf.importing.formats.table import Options
from jbf.importing.targets import FRICTION, MOTION, wanted_unit
from jbf.records.checks import LARGEST
from jbf.records.rig import Rig
from jbf.records.run import PathLike
from jbf.records.toml_file import number, read_toml, refuse_unknown, table

_QUOTED = re.compile(r"`[^`]*`")
RIG = ("drive", "bearing", "lubricant", "load")
SECTIONS = ("file", "columns", "clocks", "align", "cut", *RIG)


class OpenQuestions(InputError):
    """Error: information that an import requires is missing.

    Attributes
    ----------
    lines
        Each question, with its file.
    """

    def __init__(self, lines: Sequence[str], *, problem: str, **place: Any) -> None:
        self.lines = tuple(lines)
        more = len(lines) - 1
        super().__init__(problem=f"{problem} (and {more} more)" if more else problem, **place)

    def __reduce__(self) -> tuple[object, ...]:
        return partial(InputError, **self._fields()), ()


@dataclass(frozen=True)
class Map:
    """Contents of a map file: how the columns of files become runs of a rig.

    Attributes
    ----------
    columns, clocks
        Expressions over the columns of the file, by column of a run.
    options
        Options for reading files.
    cut
        Settings for cutting a recording into runs.
    rig
        Sections of a `rig.toml`.
    path
        File of the map; None for a proposed map.
    beside
        Further files of the recording, with separate clocks.
    align
        Common signal, or seconds added to the times, by stem of a further file.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(0.0, 2.0, 0.1)
    >>> jbf.Run.from_arrays(t, np.cos(t), np.sign(np.cos(t))).write_csv("sweep.csv")
    >>> jbf.look("sweep.csv").map().columns["time_s"]
    '`time_s`'
    """

    columns: Mapping[str, str]
    clocks: Mapping[str, str] = field(default_factory=dict)
    options: Options = field(default_factory=Options)
    cut: CutSettings = field(default_factory=CutSettings)
    rig: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    path: Path | None = None
    beside: tuple[Path, ...] = ()
    align: Mapping[str, str | float] = field(default_factory=dict)

    def open_questions(self) -> Iterator[InputError]:
        """Yield an error for each remaining `?` in the map."""
        sections: dict[str, Mapping[str, Any]] = {
            "columns": self.columns,
            "clocks": self.clocks,
            "align": self.align,
        }
        sections |= self.rig
        for section, content in sections.items():
            for key, value in content.items():
                if isinstance(value, str) and OPEN in _QUOTED.sub("", value):
                    yield InputError(
                        file=self.path,
                        key=f"{section}.{key}",
                        problem="is open",
                        remedy="replace the ? by its value",
                    )

    def check(self) -> Rig:
        """Check that the map is complete and return the rig.

        Raises
        ------
        InputError
            If a key is unknown or missing; an `OpenQuestions` if keys are open.
        """
        questions = [error.within(file=self.path) for error in self.open_questions()]
        if questions:
            first = questions[0]
            raise OpenQuestions(
                [str(question) for question in questions],
                problem=first.problem,
                file=first.file,
                key=first.key,
                remedy=first.remedy,
            )
        try:
            for key in (*self.columns, *self.clocks):
                wanted_unit(key)
            for key in self.clocks:
                if key not in self.columns or key == "time_s":
                    problem = "has a separate clock but is not a column"
                    remedy = "add it under [columns]"
                    raise InputError(key=f"clocks.{key}", problem=problem, remedy=remedy)
            self._complete()
            return Rig.from_mapping(self.rig)
        except InputError as error:
            raise error.within(file=self.path) from None

    def _complete(self) -> None:
        coasts = self.rig.get("drive", {}).get("friction") == "none"
        for keys, noun in ((FRICTION, "a friction"), (MOTION, "a motion")):
            if keys is FRICTION and coasts:
                continue
            if not any(key in self.columns for key in keys):
                raise InputError(
                    key="columns",
                    problem=f"contains no column for {noun}",
                    remedy=f"give one of {', '.join(keys)}",
                )
        if not self.rig:
            raise InputError(
                key="drive",
                problem="the map does not describe the machine",
                remedy='add [drive] with motion = "linear" or "rotary" and friction, or [bearing]',
            )


def read_map(path: PathLike) -> Map:
    r"""Read a map; open questions are reported later.

    Parameters
    ----------
    path : path
        The file `map.toml`.

    Returns
    -------
    Map
        Contents of the file.

    Raises
    ------
    InputError
        If the file is not TOML, or a key is unknown or has an invalid value.

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("map.toml").write_text('[columns]\nfriction_n = "force * 9.81"\n')
    >>> jbf.read_map("map.toml").columns
    {'friction_n': 'force * 9.81'}
    """
    content = read_toml(path)
    try:
        return _map_of(content, Path(path))
    except InputError as error:
        raise error.within(file=path) from None


def _map_of(content: Mapping[str, Any], path: Path) -> Map:
    refuse_unknown(content, SECTIONS)
    if "columns" not in content:
        remedy = 'add [columns] with lines such as friction_n = "Force [N]"'
        raise InputError(key="columns", problem="is missing", remedy=remedy)
    file = dict(table(content.get("file", {}), "file"))
    beside = _further_paths(file.pop("beside", []), path.parent)
    return Map(
        columns=_texts(content, "columns"),
        clocks=_texts(content, "clocks"),
        options=_options(file),
        cut=CutSettings.from_mapping(table(content.get("cut", {}), "cut"), path.parent),
        rig={name: dict(table(content[name], name)) for name in RIG if name in content},
        path=path,
        beside=beside,
        align=_align(table(content.get("align", {}), "align")),
    )


def _further_paths(names: object, folder: Path) -> tuple[Path, ...]:
    """Paths of the further files, which are relative to the folder of the map."""
    if not isinstance(names, list) or not all(isinstance(n, str) and n for n in names):
        remedy = 'write a list of files, such as ["force.csv"]'
        raise InputError(
            key="file.beside", problem=f"{names!r} is not a list of files", remedy=remedy
        )
    return tuple(folder / name for name in names)


def _align(section: Mapping[str, Any]) -> dict[str, str | float]:
    offsets: dict[str, str | float] = {}
    for key, value in section.items():
        if isinstance(value, str):
            offsets[key] = value
            continue
        try:
            seconds = number(value, f"align.{key}")
            fits = abs(seconds) <= LARGEST
        except InputError:
            fits = False
        if not fits:
            remedy = f'write a common signal, such as "drive/pos ~ {key}/pos", or seconds'
            raise InputError(
                key=f"align.{key}", problem=f"{value!r} is not a signal or an offset", remedy=remedy
            )
        offsets[key] = seconds
    return offsets


def _texts(content: Mapping[str, Any], section: str) -> dict[str, str]:
    texts = {}
    for key, value in table(content.get(section, {}), section).items():
        if not isinstance(value, str):
            raise InputError(
                key=f"{section}.{key}",
                problem=f"{value!r} is not text",
                remedy='write an expression in quotes, such as "Force [N] / 2"',
            )
        texts[key] = value
    return texts


_KINDS: dict[str, tuple[type | tuple[type, ...], str]] = {
    "delimiter": (str, 'text, such as ";"'),
    "decimal": (str, '"," or "."'),
    "thousands": (str, 'text, such as "."'),
    "encoding": (str, 'text, such as "latin-1"'),
    "header": (int, "a row number, 0 if there is none"),
    "units": (int, "a row number, 0 if there is none"),
    "table": (str, "the name of a sheet, group or topic"),
    "rate_hz": ((int, float), "a number above zero"),
    "steady": (bool, "true or false"),
    "dates": (str, '"day_first" or "month_first"'),
    "empty": (list, 'a list of words, such as ["OFF"]'),
}


def _options(section: Mapping[str, Any]) -> Options:
    refuse_unknown(section, [*(f.name for f in fields(Options)), "beside"], "file.")
    given = dict(section)
    for key, value in given.items():
        kind, expected = _KINDS[key]
        valid = isinstance(value, kind) and isinstance(value, bool) == (kind is bool)
        if key == "decimal":
            valid = value in (",", ".")
        elif key == "dates":
            valid = value in ("day_first", "month_first")
        elif key == "rate_hz":
            valid = valid and 0.0 < value <= LARGEST
        elif key in ("header", "units"):
            valid = valid and value >= 0
        elif key == "delimiter":
            valid = valid and len(value) == 1
        elif key == "empty":
            valid = valid and all(isinstance(word, str) for word in value)
        if not valid:
            raise InputError(
                key=f"file.{key}", problem=f"{value!r} is not valid", remedy=f"write {expected}"
            )
    if "empty" in given:
        given["empty"] = tuple(given["empty"])
    return Options(**given)
