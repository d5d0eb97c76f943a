"""Parquet files, by pyarrow, in batches; units come from the metadata of the fields."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from jbf.importing.formats.arrays import first_instant, seconds
from jbf.importing.formats.table import BLOCK, Column, Options, Source, Table, Values, as_numbers


class ParquetSource(Source):
    """Open Parquet file with one table."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._origin: np.datetime64 | None = None
        # With pre-buffering, a file of one gigabyte would stay in memory.
        self._file = pq.ParquetFile(path, pre_buffer=False, buffer_size=1 << 20)
        schema = self._file.schema_arrow
        columns = [c for field in schema if (c := _column(field)) is not None]
        self.tables = (Table("", tuple(columns), rows=self._file.metadata.num_rows),)

    def read_blocks(self, table: Table, names: Sequence[str]) -> Iterator[dict[str, Values]]:
        """Yield the named columns in batches of rows."""
        kinds = {name: table.column(name).kind for name in names}
        for batch in self._file.iter_batches(BLOCK, columns=list(dict.fromkeys(names))):
            block: dict[str, Values] = {}
            for name in names:
                column = batch.column(name)
                if kinds[name] == "instant":
                    values = column.cast(pa.timestamp("ns")).to_numpy(zero_copy_only=False)
                    # All columns of dates share one origin, so that their clocks can be compared.
                    self._origin = self._origin or first_instant(values)
                    block[name] = seconds(values, self._origin)
                elif kinds[name] == "word":
                    block[name] = np.array(column.to_pylist(), dtype=object)
                else:
                    is_integer = pa.types.is_integer(column.type) and column.null_count == 0
                    numbers = column if is_integer else column.cast(pa.float64(), safe=False)
                    block[name] = as_numbers(numbers.to_numpy(zero_copy_only=False))
            yield block

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _column(field: Any) -> Column | None:
    metadata = {
        key.decode().lower(): value.decode("utf-8", "replace")
        for key, value in (field.metadata or {}).items()
    }
    unit = metadata.get("unit") or metadata.get("units") or ""
    kind = field.type
    if pa.types.is_timestamp(kind):
        return Column(field.name, "", "instant")
    if pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_decimal(kind):
        return Column(field.name, unit)
    if pa.types.is_boolean(kind) or pa.types.is_duration(kind):
        return None
    if pa.types.is_string(kind) or pa.types.is_large_string(kind) or pa.types.is_dictionary(kind):
        return Column(field.name, "", "word")
    return None


def open_parquet(path: Path, options: Options) -> Source:
    """Open a Parquet file as a source of one table."""
    return ParquetSource(path)
