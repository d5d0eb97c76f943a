"""Columns of a file that hold a known quantity in another unit, which `jbf import` converts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

from jbf.records.findings.finding import Finding
from jbf.units.unit import unit_of_name


def in_other_units(names: Iterable[str], columns: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield name and unit of each name that has the quantity of `columns` in another unit.

    A name has this quantity if it consists of the stem of one of the columns and a unit that
    can be converted to that of the column: `angle_deg` for `angle_rad`.
    """
    known = [named for column in columns if (named := unit_of_name(column))]
    for name in names:
        named = unit_of_name(name)
        if name in columns or named is None:
            continue
        stem, unit = named
        if any(stem.lower() == s and unit.fits(u) for s, u in known):
            yield name, unit.text


def unread_columns(
    run: str, header: Collection[str], quantities: Iterable[Sequence[str]]
) -> tuple[Finding, ...]:
    """Report columns in another unit, for the quantities that no known column holds.

    Parameters
    ----------
    run
        Name of the run.
    header
        Columns of the file.
    quantities
        Known columns of each quantity.
    """
    return tuple(
        Finding(
            "other_unit",
            columns[0],
            run,
            0.0,
            "1",
            "kept, not used",
            f"{name}, in {unit}, is not read as {columns[0]}; jbf import converts it",
        )
        for columns in quantities
        if not set(columns) & set(header)
        for name, unit in in_other_units(header, columns)
    )
