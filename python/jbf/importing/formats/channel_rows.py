"""Exports of TwinCAT Scope: rows that describe the channels, each with a key in front.

The key stands again above each column of times: `Name;POS;VEL;Name;TRQ` are two tables next to each
other, POS and VEL with the times of the first column, TRQ with those of the fourth. Without columns
of times the sample time of each channel is its clock.
"""

from __future__ import annotations

from collections.abc import Sequence

from jbf.importing.formats.dates import Instants, as_date, is_file_time
from jbf.importing.formats.layout import Layout, Part, Row
from jbf.importing.formats.table import unique

NAME, UNIT, PERIOD = "name", "unit", "sampletime[ms]"
KEYS = ("data-type", "symbolname", "netid", "port", "symbolbased", "symbolcomment", UNIT, PERIOD)
"""Keys of rows that describe channels, in small letters."""
FEWEST = 2
"""Rows of such keys from which on a file is an export of channels."""
TIME, TIME_UNIT = "time", "ms"
_STARTS = ("starttime of export", "startrecord")


def lay_out_channels(rows: Sequence[Row]) -> Layout | None:
    """Layout of an export of channels; None of any other file.

    Parameters
    ----------
    rows
        First rows of the file, without empty ones.
    """
    named = None
    described: dict[str, list[str]] = {}
    samples: Row | None = None
    start = None
    for number, cells in rows:
        key = cells[0].strip().lower()
        if key == NAME and not described:
            named = cells
        elif key in KEYS and named is not None:
            described.setdefault(key, cells)
        elif key[:1].isalpha() and described:
            continue  # a row that describes something else, such as the scale
        elif key in _STARTS and len(cells) > 1 and is_file_time(cells[1]):
            start = as_date(int(Instants().parse(cells[1:2], [False])[0]))
        elif len(described) >= FEWEST:
            samples = (number, cells)
            break
    if named is None or samples is None:
        return None
    return _layout(named, described, samples, start)


def _layout(
    named: Sequence[str], described: dict[str, list[str]], samples: Row, start: str | None
) -> Layout:
    key = named[0]
    clocks = [at for at, cell in enumerate(named[:-1]) if cell in (key, "") and named[at + 1]]
    channels = [at for at, cell in enumerate(named) if at not in clocks and cell]
    first, cells = samples
    filled = len(cells) if any(cells[len(named) :]) else len(cells[: len(named)])
    without = filled <= len(channels) < len(named) or not any(
        cells[at] for at in clocks if at < len(cells)
    )
    shift = len(named) - len(channels) if filled <= len(channels) else 0
    periods = _cells(described, PERIOD, named, clocks)
    parts: list[Part] = []
    if without:
        by_period: dict[str, list[int]] = {}
        for at in channels:
            by_period.setdefault(periods[at], []).append(at)
        parts = [Part(tuple(own), None, _rate(period)) for period, own in by_period.items()]
    else:
        ends = [*clocks[1:], len(named)]
        for clock, end in zip(clocks, ends, strict=True):
            own = [at for at in channels if clock < at < end]
            parts.append(Part((clock, *own), clock))
    names = [TIME if at in clocks else named[at] for at in range(len(named))]
    units = _cells(described, UNIT, named, clocks)
    stated = [TIME_UNIT if at in clocks else _unit(units[at]) for at in range(len(named))]
    if shift:
        # The columns of times are not there at all.
        place = {at: k for k, at in enumerate(channels)}
        parts = [Part(tuple(place[at] for at in p.columns), None, p.rate_hz) for p in parts]
        names, stated = [names[at] for at in channels], [stated[at] for at in channels]
    return Layout(tuple(unique(names)), tuple(stated), first, parts=tuple(parts), start=start)


def _cells(
    described: dict[str, list[str]], key: str, named: Sequence[str], clocks: Sequence[int]
) -> list[str]:
    """The cells of a key's row; empty where its keys do not stand where those of the names do."""
    cells = described.get(key, [])
    aligned = all(at < len(cells) and cells[at].lower() in (key, "") for at in clocks)
    return [*cells, *[""] * len(named)][: len(named)] if aligned else [""] * len(named)


def _unit(cell: str) -> str:
    """The unit of `mm/s (Velocity)`; empty of `(None)`."""
    return cell.partition("(")[0].strip()


def _rate(period_ms: str) -> float | None:
    """Samples a second of a sample time, whichever mark its decimals have."""
    try:
        period = float(period_ms.replace(",", "."))
    except ValueError:
        return None
    return 1e3 / period if period > 0.0 else None
