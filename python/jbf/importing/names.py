"""Names by which expressions refer to file columns."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from jbf.importing.columns import parse_header
from jbf.importing.formats.table import Table


def column_names(tables: Sequence[Table]) -> dict[str, str]:
    """Map each name that denotes one column to the column: with or without unit or table name.

    A column name that occurs in several tables is valid only together with the name of its table.
    """
    occurrences = Counter(column.name for table in tables for column in table.columns)
    column_of_name: dict[str, str] = {}
    counts: Counter[str] = Counter()
    shorter: dict[str, str] = {}
    for table in tables:
        for column in table.columns:
            if occurrences[column.name] == 1:
                column_of_name[column.name] = column.name
            column_of_name[f"{table.name}/{column.name}"] = qualified(
                table, column.name, occurrences
            )
            name = parse_header(column.name).name
            for candidate in (name, *([f"{table.name}/{name}"] if table.name else [])):
                counts[candidate] += 1
                shorter[candidate] = qualified(table, column.name, occurrences)
    for name, column_name in shorter.items():
        if counts[name] == 1:
            column_of_name.setdefault(name, column_name)
    return column_of_name


def qualified(table: Table, name: str, occurrences: Counter[str]) -> str:
    """Name of a column in expressions, with its table name if it occurs in several tables."""
    return name if occurrences[name] == 1 else f"{table.name}/{name}"


def columns_by_name(tables: Sequence[Table]) -> dict[str, tuple[Table, str]]:
    """Map each name of `column_names` to the table and the column that it denotes."""
    occurrences = Counter(column.name for table in tables for column in table.columns)
    return {
        qualified(table, column.name, occurrences): (table, column.name)
        for table in tables
        for column in table.columns
    }


def column_units(tables: Sequence[Table]) -> dict[str, str]:
    """Unit that the file states for each column, by the name of the column."""
    units = {}
    for name, (table, column_name) in columns_by_name(tables).items():
        column = table.column(column_name)
        if column.kind == "instant":
            units[name] = "s"
        else:
            units[name] = column.unit or parse_header(column.name).unit
    return units
