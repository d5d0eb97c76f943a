"""Channels of a map: the table of the file that contains each channel, and its time expression."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from jbf.errors import InputError
from jbf.importing.expression import Node, parse_expression, references
from jbf.importing.formats.table import Options, Source, Table
from jbf.importing.mapping import Map
from jbf.importing.names import column_names, columns_by_name
from jbf.importing.side_by_side import SideBySide
from jbf.importing.targets import wanted_unit
from jbf.units.unit import ONE, Unit

CUT_COLUMN, KEPT_COLUMN = "cut", "kept"
"""Auxiliary columns for cutting: set point or run number, and whether a row is kept."""
SIGNAL_COLUMN = "signal"
"""Column of a signal that files with separate clocks have in common."""
RATE = "rate"
"""Value used instead of a clock expression if only the sampling rate is known."""
CUTTING_COLUMNS = (CUT_COLUMN, KEPT_COLUMN)


@dataclass(frozen=True)
class Channel:
    """One column of a run: its expression, its source table and its time.

    Attributes
    ----------
    key, unit
        Column of the run, and its unit.
    text, node
        Expression over the columns of the file, as text and parsed.
    table
        Table of the file with the columns of the expression.
    clock
        Expression of the times, or `RATE`.
    """

    key: str
    text: str
    node: Node
    table: Table
    clock: str
    unit: Unit


def channels_of(source: Source, mapping: Map) -> list[Channel]:
    """Resolve the columns of a map to channels of a file.

    Raises
    ------
    InputError
        If a column does not exist, or the columns of one expression have different clocks.
    """
    tables = tables_of(source, mapping.options)
    names = column_names(tables)
    all_columns = [column.name for table in tables for column in table.columns]
    places = columns_by_name(tables)
    expressions = {key: text for key, text in mapping.columns.items() if key != "time_s"}
    if mapping.cut.by and mapping.cut.column is not None:
        expressions[CUT_COLUMN] = mapping.cut.column
    if mapping.cut.keep is not None:
        expressions[KEPT_COLUMN] = mapping.cut.keep.difference
    channels = []
    for key, text in expressions.items():
        section = {CUT_COLUMN: "cut.column", KEPT_COLUMN: "cut.keep"}.get(key, f"columns.{key}")
        try:
            node = parse_expression(text, names, all_columns)
        except InputError as error:
            raise InputError(key=section, problem=error.problem, remedy=error.remedy) from None
        of_tables = {places[r.column][0].name for r in references(node)}
        if len(of_tables) != 1:
            problem = (
                "combines columns with different clocks" if of_tables else "contains no column"
            )
            remedy = "use columns of one group; columns are not resampled here"
            raise InputError(key=section, problem=f"{text} {problem}", remedy=remedy)
        (table_name,) = of_tables
        table = next(t for t in tables if t.name == table_name)
        clock = clock_of(key, table, tables, mapping, names, places)
        unit = ONE if key in CUTTING_COLUMNS else wanted_unit(key)
        channels.append(Channel(key, text, node, table, clock, unit))
    return channels


def tables_of(source: Source, options: Options) -> tuple[Table, ...]:
    """Tables of a file that the options select."""
    if options.table is None or isinstance(source, SideBySide):
        return source.tables
    for table in source.tables:
        if table.name == options.table:
            return (table,)
    names = ", ".join(table.name for table in source.tables)
    problem = f'contains no "{options.table}"'
    raise InputError(file=source.path, problem=problem, remedy=f"it contains: {names}")


def clock_of(
    key: str,
    table: Table,
    tables: tuple[Table, ...],
    mapping: Map,
    names: Mapping[str, str],
    places: Mapping[str, tuple[Table, str]],
) -> str:
    """Expression of the times of a column of a run; `RATE` if only its sampling rate is known."""
    if mapping.options.steady:
        return RATE
    text = mapping.clocks.get(key, mapping.columns.get("time_s"))
    if text is not None:
        node = parse_expression(text, names)
        if {places[r.column][0].name for r in references(node)} == {table.name}:
            return text
        if key in mapping.clocks:
            problem = "is in another group than its column"
            raise InputError(
                key=f"clocks.{key}", problem=problem, remedy="give a time of the same group"
            )
    if table.clock is not None:
        return f"`{table.name}/{table.clock}`"
    if text is None and (mapping.options.rate_hz or table.rate_hz):
        return RATE
    if text is not None:
        problem = f"has no clock: time_s is in another group than [{table.name}]"
        raise InputError(
            key=f"columns.{key}", problem=problem, remedy=f"give its time under [clocks] as {key}"
        )
    raise InputError(
        key="columns.time_s",
        problem="is missing",
        remedy="give the column of times, or rate_hz under [file]",
    )
