"""Layout of a table of cells: rows of names and units, and the first row of samples.

The functions work on rows of text, so that the same rules apply to workbook sheets and text files.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

from jbf.errors import InputError
from jbf.importing.columns import parse_header, split_unit
from jbf.importing.formats.dates import is_instant
from jbf.importing.formats.dialect import is_empty
from jbf.importing.formats.table import unique
from jbf.units.unit import parse_unit

Row = tuple[int, list[str]]
"""Number of a row in the file, counted from 1, and its cells."""

_RATE = re.compile(
    r"(?P<word>abtast|sampl|rate|frequen|frequenz|fréquence|interval|intervall|period|dt\b|échant)",
    re.IGNORECASE,
)
_VALUE = re.compile(r"(?P<value>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*(?P<unit>[a-zµμA-Z/]*)")
_NUMERAL = re.compile(r"[+-]?\d+(?:[.,]\d*)?(?:[eE][+-]?\d+)?")
_EXACT = 16
"""Number of digits from which a numeral may exceed the precision of a float."""
LABEL = "label of"
"""Name prefix of a column that holds, in each row, the name of the next column."""
_HZ = {"hz": 1.0, "khz": 1e3, "s/s": 1.0, "sps": 1.0}


@dataclass(frozen=True)
class Part:
    """One of several tables in adjacent columns of a file.

    Attributes
    ----------
    columns
        Indices of its columns, counted from 0.
    clock
        Index of its time column; None without a time column.
    rate_hz
        Sampling rate, if the file states it, Hz.
    """

    columns: tuple[int, ...]
    clock: int | None
    rate_hz: float | None = None


@dataclass(frozen=True)
class Layout:
    """Names and units of the columns of a table, and its first row of samples.

    Attributes
    ----------
    names, units
        Names and units of the columns; empty texts where there are none.
    first
        Number of the first row of samples, counted from 1.
    rate_hz
        Sampling rate, if the lines before the header state it, Hz.
    headless
        Whether the file has no row of names.
    parts
        Tables next to each other; empty if all columns share their rows.
    start
        Date of the first instant, if the lines before the header state it.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    first: int
    rate_hz: float | None = None
    headless: bool = False
    parts: tuple[Part, ...] = ()
    start: str | None = None


def lay_out(
    rows: Sequence[Row],
    is_number: Callable[[str], bool],
    header: int | None = None,
    units: int | None = None,
) -> Layout:
    """Determine the layout of a table from its first rows.

    Parameters
    ----------
    header, units
        Rows that the user has stated; 0 if the row does not exist.

    Raises
    ------
    InputError
        If there are no rows of numbers. The error names no file.
    """

    def counts(cell: str) -> bool:
        return is_number(cell) or is_instant(cell) or is_empty(cell)

    def numeric(cells: list[str]) -> int:
        return sum(is_number(cell) or is_instant(cell) for cell in cells)

    wide = [len(_trimmed(cells)) for _, cells in rows if numeric(cells)]
    if not wide:
        raise InputError(problem="contains no numeric rows", remedy="name a file with samples")
    width = Counter(wide[len(wide) // 2 :]).most_common(1)[0][0]
    # Shorter tables may end before the tables next to them.
    width = max([width, *(len(cells) for _, cells in rows if _side_by_side(cells))])
    first = _first_sample(rows, width, numeric, counts)
    if first is None:
        raise InputError(problem="contains no numeric rows", remedy="name a file with samples")
    if header:
        first = max(first, next((i for i, (n, _) in enumerate(rows) if n > header), first))
        first = max(first, next((i for i, (n, _) in enumerate(rows) if n > (units or 0)), first))
    above = list(rows[:first])
    # If the last columns begin with empty cells, only the row of names shows them.
    header_widths = [len(_trimmed(cells)) for _, cells in above[-3:] if len(_trimmed(cells)) > 1]
    width = max([width, *header_widths])
    rate = _rate(above)
    heads = [row for row in above if _may_be_head(row[1], width)]
    unit_cells = [""] * width
    if units:
        unit_cells = _row(above, units)
        heads = [row for row in heads if row[0] != units]
    elif units is None:
        unit_row = next((row for row in reversed(heads) if _is_units(row[1])), None)
        if unit_row is not None:
            unit_cells, heads = unit_row[1], [row for row in heads if row is not unit_row]
    number = rows[first][0]
    labels = _labels([cells for _, cells in rows[first : first + 3]])
    if header is None and labels is not None:
        return Layout(labels, _padded(unit_cells, len(labels)), number, rate)
    if header == 0 or (header is None and not heads):
        names = tuple(f"column {i}" for i in range(1, width + 1))
        return Layout(names, _padded(unit_cells, width), number, rate, headless=True)
    names_row = _row(above, header) if header else heads[-1][1]
    named = _padded(names_row, width)
    parts = _side_by_side(named)
    groups = [cells for n, cells in heads if header is None and cells is not names_row]
    if groups and len({n for n in named if n}) < sum(map(bool, named)):
        named = tuple(
            f"{group} {name}".strip()
            for group, name in zip(_repeat_group_names(groups[-1], width), named, strict=True)
        )
    cleaned = tuple(_bare_unit(cell) for cell in _padded(unit_cells, width))
    return Layout(tuple(unique(named)), cleaned, number, rate, parts=parts)


def _side_by_side(names: Sequence[str]) -> tuple[Part, ...]:
    """Tables in adjacent columns, each of which begins with the same column name."""
    clocks = [at for at, name in enumerate(names) if name == names[0]]
    ends = [*clocks[1:], len(names)]
    separated = all(end - at > 1 for at, end in zip(clocks, ends, strict=True))
    if len(clocks) < 2 or not separated or parse_header(names[0]).kind != "time":
        return ()
    return tuple(Part(tuple(range(at, end)), at) for at, end in zip(clocks, ends, strict=True))


def merged(parts: tuple[Part, ...], rows: Iterable[Sequence[str]]) -> tuple[Part, ...]:
    """Merge tables in adjacent columns that have the same times in all rows.

    Parameters
    ----------
    rows
        Cells of every row of samples; read only if there are several tables with times.
    """
    clocks = [part.clock for part in parts if part.clock is not None]
    if len(clocks) < len(parts) or len(parts) < 2:
        return parts
    groups = [list(range(len(parts)))]
    for cells in rows:
        if all(cells[clocks[i]] == cells[clocks[group[0]]] for group in groups for i in group):
            continue
        split = list[list[int]]()
        for group in groups:
            by_time: dict[float | str, list[int]] = {}
            for i in group:
                by_time.setdefault(_instant(cells[clocks[i]]), []).append(i)
            split += by_time.values()
        groups = split
    merged_parts = []
    for group in groups:
        columns = [at for i in group for at in parts[i].columns if at != clocks[i]]
        merged_parts.append(replace(parts[group[0]], columns=(clocks[group[0]], *columns)))
    return tuple(merged_parts)


def _instant(cell: str) -> float | str:
    """Normalise a time for a comparison in which `0` equals `0.0`."""
    cell = cell.strip()
    return float(cell.replace(",", ".")) if len(cell) < _EXACT and _is_numeral(cell) else cell


def _labels(rows: Sequence[list[str]]) -> tuple[str, ...] | None:
    """Column names of rows in which each value follows its name, as in `x 1.5 y 2.5`."""
    words = {tuple(cells[::2]) for cells in rows}
    values = [cell for cells in rows for cell in cells[1::2]]
    if len(words) != 1 or any(len(cells) % 2 for cells in rows) or not any(words):
        return None
    (names,) = words
    if any(_is_numeral(name) for name in names) or not all(map(_is_numeral, values)):
        return None
    columns = [text for name in unique(names) for text in (f"{LABEL} {name}", name)]
    return tuple(columns)


def _is_numeral(cell: str) -> bool:
    return _NUMERAL.fullmatch(cell) is not None


def _first_sample(
    rows: Sequence[Row],
    width: int,
    numeric: Callable[[list[str]], int],
    counts: Callable[[str], bool],
) -> int | None:
    """Index of the first row of samples that is followed by further rows of samples."""

    def sample(cells: list[str]) -> bool:
        cells = _trimmed(cells)
        mostly_numeric = sum(map(counts, cells)) >= max(1, (len(cells) + 1) // 2)
        return (
            numeric(cells) > 0 and mostly_numeric and abs(len(cells) - width) <= max(1, width // 2)
        )

    for at in range(len(rows)):
        following = rows[at : at + 3]
        if all(sample(cells) for _, cells in following):
            # A row of names may hold numbers (years, channels); a row of samples holds no names.
            current = _trimmed(rows[at][1])
            after = _trimmed(rows[at + 1][1]) if at + 1 < len(rows) else current
            if sum(map(counts, current)) >= sum(map(counts, after)):
                return at
    return None


def _may_be_head(cells: list[str], width: int) -> bool:
    """Whether a row may contain the column names: it is about as wide as the samples."""
    return len(cells) >= min(width, 2) and sum(map(bool, cells)) >= max(1, width // 2)


def _is_units(cells: list[str]) -> bool:
    """Whether a row of cells contains units."""
    full = [_bare_unit(cell) for cell in cells if cell]
    unit_count = sum(parse_unit(cell) is not None for cell in full)
    # `s` is a unit and a name; whole words that name a quantity do not occur in a row of units.
    named = sum(parse_header(cell).kind is not None and len(cell) > 2 for cell in full)
    return bool(full) and unit_count > 0.5 * len(full) and named < unit_count


def _bare_unit(cell: str) -> str:
    """Text of a unit cell without brackets."""
    cell = cell.strip()
    if len(cell) > 2 and cell[0] + cell[-1] in ("[]", "()", "{}", "<>"):
        return cell[1:-1].strip()
    return "" if cell in ("-", "[]", "()", "[-]", "(-)", "YYYY-MM-DD") else cell


def _row(rows: Sequence[Row], number: int) -> list[str]:
    """Cells of the row with this number."""
    for n, cells in rows:
        if n == number:
            return cells
    raise InputError(
        row=number, problem="is not before the samples", remedy="correct [file] header and units"
    )


def _trimmed(cells: Sequence[str]) -> list[str]:
    """Cells of a row without empty cells at its end."""
    end = len(cells)
    while end and not cells[end - 1]:
        end -= 1
    return list(cells[:end])


def _padded(cells: Sequence[str], width: int) -> tuple[str, ...]:
    """Cells of a row, truncated or extended by empty cells to `width` cells."""
    return tuple([*cells, *[""] * width][:width])


def _repeat_group_names(cells: Sequence[str], width: int) -> list[str]:
    """Repeat a group name, which is written above its first column only, for all its columns."""
    repeated: list[str] = []
    for cell in _padded(cells, width):
        repeated.append(cell or (repeated[-1] if repeated else ""))
    return repeated


def _rate(rows: Sequence[Row]) -> float | None:
    """Sampling rate stated in a line before the header, Hz, or None."""
    for _, cells in rows:
        line = " ".join(cells)
        word = _RATE.search(line)
        values = [v for v in _VALUE.finditer(line) if word and v.start() > word.start()]
        if word is None or not values:
            continue
        value = float(values[0]["value"].replace(",", "."))
        unit = values[0]["unit"] or split_unit(line[: values[0].start()].strip(" :=;"))[1]
        if not value > 0.0:
            continue
        if unit.lower() in _HZ:
            return value * _HZ[unit.lower()]
        time_unit = (
            parse_unit(unit) if unit in ("s", "ms", "us", "µs", "ns", "sec", "min") else None
        )
        if time_unit is not None:
            return 1.0 / (value * time_unit.in_si)
    return None
