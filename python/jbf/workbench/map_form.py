"""Form for a map on the page: quantity, unit and sign of each column of the file.

The text of the map is authoritative. The form is derived from it and changes it. Elements that the
form cannot represent (a formula, a cut, a clock) remain unchanged.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError

from jbf.errors import InputError
from jbf.importing.columns import split_unit
from jbf.importing.expression import OPEN
from jbf.importing.formats.registry import open_source
from jbf.importing.formats.table import Values
from jbf.importing.guess_rig import as_bearing, as_drive, guess_rig
from jbf.importing.mapping import Map, read_map
from jbf.importing.rig_columns import at_journal
from jbf.importing.targets import KNOWN, wanted_unit
from jbf.records.rig import Rig
from jbf.units.unit import parse_unit

FIRST = 3
"""Number of first values of a column that the form shows."""
HEAD, SHAPE = 5_000, 120
"""Number of rows whose course the form shows, and of the points of its curve."""
PLAIN = re.compile(r"\s*(?P<sign>-?)\s*`(?P<column>[^`]+)`\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*")
_ANSWERED = re.compile(r"^# Open:\n(?:#   .*\n)+\n?", re.MULTILINE)
"""Comments with open questions in a guessed map; removed because the form shows them."""
_LINE = re.compile(r"\w+\s*=")
WORDS = {
    "time_s": "time",
    "position_m": "position of the slide",
    "angle_rad": "angle of the shaft or joint",
    "weight_angle_rad": "angle of a link behind several joints, on which its weight acts",
    "velocity_m_s": "speed of the slide or surface",
    "velocity_rad_s": "angular speed of the joint",
    "speed_rpm": "speed of the shaft or joint, in revolutions",
    "friction_n": "friction force",
    "torque_n_m": "torque at the joint",
    "motor_torque_n_m": "torque of the motor",
    "current_a": "motor current",
    "torque_percent": "torque, % of the rated torque",
    "force_percent": "force, % of the rated force",
    "load_n": "load (normal force)",
    "temperature_c": "temperature",
    "pressure_pa": "pressure",
    "motor_angle_rad": "angle of the motor",
    "motor_velocity_rad_s": "angular speed of the motor",
    "motor_speed_rpm": "speed of the motor, in revolutions",
}
"""Plain description of each possible column of a run."""
SUGGESTED = (
    "s", "ms", "us", "ns", "min", "m", "cm", "mm", "um", "in", "rad", "deg", "rev", "m/s", "mm/s",
    "um/s", "m/min", "mm/min", "rad/s", "deg/s", "rpm", "N", "mN", "kN", "lbf", "N m", "mN m",
    "N cm", "A", "mA", "%", "Pa", "kPa", "MPa", "bar", "mbar", "psi", "°C", "K",
)  # fmt: skip
"""Units offered in the form; any other unit may be entered."""


def file_columns(path: Path) -> list[dict[str, Any]]:
    """Name, unit, kind, first values and shape of each column of a file, as in the file.

    The shape is the course of the first rows, scaled to 0 to 1 (`least` to `most`); None for a
    column of words.
    """
    columns = []
    with open_source(path) as source:
        for table in source.tables:
            head = source.head(table, HEAD)
            for column in table.columns:
                values = head.get(column.name, np.empty(0))
                columns.append(
                    {
                        "name": column.name,
                        "unit": column.unit or split_unit(column.name)[1],
                        "kind": column.kind,
                        "first": [_shown(value) for value in values[:FIRST]],
                        **_course(values),
                    }
                )
    return columns


def _course(values: Values) -> dict[str, Any]:
    """Course of the values in at most `SHAPE` points, scaled to 0 to 1, and its ends, as text.

    The `shape` of a column of words is None.
    """
    if values.dtype.kind not in "fiu" or not len(values):
        return {"shape": None}
    numbers = values[:: max(len(values) // SHAPE, 1)].astype(np.float64)
    finite = numbers[np.isfinite(numbers)]
    if not len(finite):
        return {"shape": None}
    low, size = finite.min(), float(np.ptp(finite)) or 1.0
    shape = [round(float(v), 3) if np.isfinite(v) else None for v in (numbers - low) / size]
    return {"shape": shape, "least": _shown(low), "most": _shown(finite.max())}


def _shown(value: Any) -> str:
    if isinstance(value, float | np.floating):
        # Stamps, such as seconds since 1970, differ only in their last digits.
        return f"{value:.6g}" if abs(value) < 1e6 else f"{value:.16g}"
    return str(value)


def quantities() -> list[dict[str, Any]]:
    """Possible quantities of a column: key, description, offered units."""
    entries = []
    for key in (*WORDS, *(k for k in KNOWN if k not in WORDS)):
        entries.append({"key": key, "words": WORDS.get(key, key), "units": units_for(key)})
    return entries


def units_for(key: str) -> list[str]:
    """Suggested units of a column of a run."""
    required = wanted_unit(key)
    return [u for u in SUGGESTED if (unit := parse_unit(u)) is not None and unit.fits(required)]


def form_of(text: str) -> dict[str, Any]:
    """Contents of the form for the text of a map.

    Raises
    ------
    InputError
        The text is not a map.
    """
    mapping = map_of(text)
    rows = []
    for key, expression in mapping.columns.items():
        match = PLAIN.fullmatch(expression)
        row: dict[str, Any] = {"key": key, "expression": expression}
        if match is not None:
            row |= {
                "column": match["column"],
                "unit": match["unit"],
                "turned": bool(match["sign"]),
            }
        rows.append(row)
    return {"rows": rows, "rig": {name: dict(part) for name, part in mapping.rig.items()}}


def rewritten(
    text: str, columns: Mapping[str, str], rig: Mapping[str, Any], rate_hz: float | None = None
) -> str:
    """Replace columns and rig values in the text of a map.

    If the columns imply a different machine, its sections are guessed again; values already filled
    in are kept. Once the values of a bearing are complete, a torque and a rotational speed are
    converted to the surface of the journal.

    Parameters
    ----------
    text
        Text of the map.
    columns
        Column of a run to its expression.
    rig
        Values by dotted name, such as `drive.pitch_m`; `machine` is `bearing` or `drive`, if the
        user selects another machine.
    rate_hz
        Sampling rate of a file without times, Hz.

    Raises
    ------
    InputError
        The text is not a map.
    """
    before = map_of(text)
    document: Any = _parsed(_ANSWERED.sub("", text))
    if "machine" in rig:
        convert = as_bearing if rig["machine"] == "bearing" else as_drive
        columns, sections = convert(columns)
    else:
        sections = _sections(before, columns, rig)
        columns = _at_journal(columns, sections)
    _put(document["columns"], {k: v for k, v in columns.items() if k in before.columns})
    for name in set(before.rig) - set(sections):
        del document[name]
    for name, content in sections.items():
        if name not in document:
            document[name] = tomlkit.table()
        _put(document[name], content)
    if rate_hz is not None:
        document.setdefault("file", tomlkit.table())["rate_hz"] = rate_hz
    new = [f"{k} = {_quoted(v)}" for k, v in columns.items() if k not in before.columns]
    return _with_lines(tomlkit.dumps(document), new)


def _with_lines(text: str, new: Sequence[str]) -> str:
    """Insert lines after the last line of the section of columns."""
    lines = text.split("\n")
    if not new:
        return text
    at = begin = lines.index("[columns]")
    for number, line in enumerate(lines[begin + 1 :], begin + 1):
        if line.startswith("["):
            break
        if _LINE.match(line):
            at = number
    return "\n".join([*lines[: at + 1], *new, *lines[at + 1 :]])


def _quoted(text: str) -> str:
    return tomlkit.item(text).as_string()


def _sections(
    before: Map, columns: Mapping[str, str], rig: Mapping[str, Any]
) -> dict[str, dict[str, Any]]:
    """Sections of the rig in a map with replaced columns and rig values.

    Parameters
    ----------
    before
        Map before the replacement.
    columns
        New expressions of the columns, by column of a run.
    rig
        New values of the rig by dotted name, such as `drive.pitch_m`.
    """
    filled = {k: v for part in before.rig.values() for k, v in part.items() if v != OPEN}
    sections = {name: dict(part) for name, part in before.rig.items()}
    if "bearing" not in sections and (set(columns) != set(before.columns) or not before.rig):
        guessed, _ = guess_rig(set(columns))
        if guessed:
            sections = {
                name: {k: filled.get(k, v) if v == OPEN else v for k, v in part.items()}
                for name, part in guessed.items()
            }
    for place, value in rig.items():
        name, _, key = place.partition(".")
        if name in sections and value != sections[name].get(key):
            sections[name].pop(key, None)
            if value not in ("", None):
                sections[name][key] = value
    return sections


def _at_journal(
    columns: Mapping[str, str], sections: Mapping[str, Mapping[str, Any]]
) -> Mapping[str, str]:
    """Columns with those of the shaft converted to the surface of a journal, if it is complete."""
    if any(value == OPEN for part in sections.values() for value in part.values()):
        return columns
    try:
        derived = at_journal(Rig.from_mapping(sections), columns)
    except InputError:  # reported by the preview
        return columns
    replaced = {source for source, _ in derived.values()}
    kept = {key: text for key, text in columns.items() if key not in replaced}
    return {**kept, **{key: text for key, (_, text) in derived.items()}}


def _put(section: Any, content: Mapping[str, Any]) -> None:
    """Replace the content of a TOML section; unchanged items keep their comments."""
    for key in [key for key in section if key not in content]:
        del section[key]
    for key, value in content.items():
        if section.get(key) != value:
            section[key] = value


def expression_of(row: Mapping[str, Any]) -> str:
    """Expression in the map for the column, unit and sign in a row of the form."""
    column = str(row["column"]).replace("`", "")
    unit = str(row.get("unit") or "").strip()
    return f"{'-' if row.get('turned') else ''}`{column}`{f' [{unit}]' if unit else ''}"


def changed_by(
    text: str,
    rows: Sequence[Mapping[str, Any]],
    rig: Mapping[str, Any],
    rate_hz: float | None = None,
) -> str:
    """Apply the changes made in a form to the text of its map.

    Raises
    ------
    InputError
        Two columns have the same assignment, or the text is not a map.
    """
    formulas = {row["key"]: row["expression"] for row in form_of(text)["rows"]
                if "column" not in row}  # fmt: skip
    columns: dict[str, str] = {}
    for row in rows:
        key = str(row["key"])
        if key in columns:
            words = WORDS.get(key, key)
            raise InputError(
                problem=f"two columns are assigned to {words}", remedy="keep one of them"
            )
        # A formula is replaced as a whole.
        columns[key] = str(row["expression"]) if "column" not in row else expression_of(row)
    other_formulas = {k: v for k, v in formulas.items() if k not in columns}
    numbers = {place: _number(value) for place, value in rig.items()}
    return rewritten(text, {**columns, **other_formulas}, numbers, rate_hz)


def _number(value: Any) -> Any:
    try:
        return int(value) if str(value).isdecimal() else float(value)
    except (TypeError, ValueError):
        return str(value)


def cut_name(text: str) -> str | None:
    """Name of the trim file in the text of a map, as written; None without one.

    Raises
    ------
    InputError
        The text is not a map.
    """
    if map_of(text).cut.file is None:
        return None
    return str(_parsed(text)["cut"]["file"])


def additional_names(text: str) -> list[str]:
    """Names of the further files in the text of a map, as written.

    Raises
    ------
    InputError
        The text is not a map.
    """
    if not map_of(text).beside:
        return []
    return [str(name) for name in _parsed(text)["file"]["beside"]]


def _parsed(text: str) -> Any:
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise InputError(
            problem=f"the map is not valid TOML ({error})", remedy="correct it"
        ) from None


def map_of(text: str) -> Map:
    """Read the text of a map.

    Raises
    ------
    InputError
        The text is not a map.
    """
    with tempfile.TemporaryDirectory(prefix="jbf-map-") as scratch:
        path = Path(scratch) / "map.toml"
        path.write_text(text, encoding="utf-8")
        try:
            return read_map(path)
        except InputError as error:
            raise without_path(error) from None


def without_path(error: InputError) -> InputError:
    """Return an error without the path of the temporary map file."""
    fields = error._fields()
    if str(fields.get("file") or "").endswith("map.toml"):
        fields["file"] = "the map"
    return InputError(**fields)
