"""Layout of TwinCAT Scope exports, in which header rows describe the channels by keys.

The key is repeated above each time column. `Name;POS;VEL;Name;TRQ` thus has two tables next to each
other: POS and VEL with the times of the first column, TRQ with those of the fourth. Without time
columns, the sample time of each channel is its clock.
"""

from __future__ import annotations

from collections.abc import Sequence

from jbf.importing.formats.dates import Instants, as_date, is_file_time
from jbf.importing.formats.layout import Layout, Part, Row
from jbf.importing.formats.table import unique

NAME, UNIT, PERIOD = "name", "unit", "sampletime[ms]"
KEYS = ("data-type", "symbolname", "netid", "port", "symbolbased", "symbolcomment", UNIT, PERIOD)
"""Keys of the rows that describe channels, in lower case."""
FEWEST = 2
"""Minimum number of rows with such keys in an export of channels."""
TIME, TIME_UNIT = "time", "ms"
_STARTS = ("starttime of export", "startrecord")


def lay_out_channels(rows: Sequence[Row]) -> Layout | None:
    """Determine the layout of a TwinCAT Scope export; None for any other file.

    Parameters
    ----------
    rows
        First rows of the file, without empty rows.
    """
    named = None
    described: dict[str, list[str]] = {}
    samples: list[Row] = []
    start = None
    for number, cells in rows:
        key = cells[0].strip().lower()
        if samples:
            samples.append((number, cells))
        elif key == NAME and not described:
            named = cells
        elif key in KEYS and named is not None:
            described.setdefault(key, cells)
        elif key[:1].isalpha() and described:
            continue  # a row that describes something else, such as the scale
        elif key in _STARTS and len(cells) > 1 and is_file_time(cells[1]):
            start = as_date(int(Instants().parse(cells[1:2], [False])[0]))
        elif len(described) >= FEWEST or (named is not None and _repeats_its_key(named)):
            samples.append((number, cells))
    if named is None or not samples:
        return None
    return _layout(named, described, samples, start)


def _repeats_its_key(named: Sequence[str]) -> bool:
    """Whether the row of channel names repeats its key above each time column."""
    return len(named) > 2 and sum(cell.strip().lower() == NAME for cell in named) > 1


def _layout(
    named: Sequence[str], described: dict[str, list[str]], samples: Sequence[Row], start: str | None
) -> Layout:
    """Create the layout from the channel names, described keys and first samples."""
    key = named[0]
    clocks = [at for at, cell in enumerate(named[:-1]) if cell in (key, "") and named[at + 1]]
    channels = [at for at, cell in enumerate(named) if at not in clocks and cell]
    periods = _cells(described, PERIOD, named, clocks)
    units = [_unit(cell) for cell in _cells(described, UNIT, named, clocks)]
    names = list(named)
    for at in clocks:
        names[at], units[at] = TIME, TIME_UNIT
    rows = [cells for _, cells in samples]
    absent = _widest(rows) == len(channels) < len(named)
    parts = []
    if absent or not any(row[at] for row in rows for at in clocks if at < len(row)):
        if absent:
            # The samples have no time columns, unlike the rows that describe the channels.
            names, units, periods = ([r[at] for at in channels] for r in (names, units, periods))
            channels = list(range(len(channels)))
        for period in dict.fromkeys(periods[at] for at in channels):
            members = tuple(at for at in channels if periods[at] == period)
            parts.append(Part(members, None, _rate(period)))
    else:
        for clock, end in zip(clocks, [*clocks[1:], len(named)], strict=True):
            parts.append(Part((clock, *(at for at in channels if clock < at < end)), clock))
    return Layout(
        tuple(unique(names)), tuple(units), samples[0][0], parts=tuple(parts), start=start
    )


def _widest(samples: Sequence[Sequence[str]]) -> int:
    """Number of cells of the longest row, without empty cells at its end."""
    return max(max((at for at, cell in enumerate(row, 1) if cell), default=0) for row in samples)


def _cells(
    described: dict[str, list[str]], key: str, named: Sequence[str], clocks: Sequence[int]
) -> list[str]:
    """Cells of a key's row by column; empty if the row is not aligned with the channel names."""
    cells = described.get(key, [])
    aligned = all(at < len(cells) and cells[at].lower() in (key, "") for at in clocks)
    return [*cells, *[""] * len(named)][: len(named)] if aligned else [""] * len(named)


def _unit(cell: str) -> str:
    """Unit in a cell such as `mm/s (Velocity)`; empty for `(None)`."""
    return cell.partition("(")[0].strip()


def _rate(period_ms: str) -> float | None:
    """Convert a sample time in ms, with a decimal point or comma, to a rate in Hz."""
    try:
        period = float(period_ms.replace(",", "."))
    except ValueError:
        return None
    return 1e3 / period if period > 0.0 else None
