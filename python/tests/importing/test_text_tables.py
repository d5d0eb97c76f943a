"""Text files of loggers: dialect and names of generated files, and values of regular blocks."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from import_cases import Text, texts
from jbf.importing.formats.csv_text import TextSource
from jbf.importing.formats.dialect import Dialect
from jbf.importing.formats.plain_lines import plain_columns
from jbf.importing.formats.table import Options

TEXTS = texts()
AMBIGUOUS = ("one column",)
"""A decimal comma in a comma-separated file splits numbers such as 0,25 into two columns."""


def read(path: Path, data: bytes) -> tuple[TextSource, dict[str, Any]]:
    """The source and all of its values."""
    path.write_bytes(data)
    source = TextSource(path, Options())
    (table,) = source.tables
    names = [column.name for column in table.columns]
    blocks = list(source.blocks(table, names))
    return source, {name: np.concatenate([b[name] for b in blocks]) for name in names}


@pytest.mark.parametrize("name", [name for name in TEXTS if name not in AMBIGUOUS])
def test_dialect_and_names_of_a_text_file_are_detected(name: str, tmp_path: Path) -> None:
    text: Text = TEXTS[name]
    source, _ = read(tmp_path / "a.csv", text.data)
    assert (source.dialect.delimiter, source.dialect.decimal) == (text.delimiter, text.decimal)
    assert source.layout.names == text.names


@pytest.mark.parametrize("delimiter", [";", "\t", "|"])
def test_date_with_a_blank_does_not_hide_the_delimiter(delimiter: str, tmp_path: Path) -> None:
    rows = [f"24.11.2026 13:05:{k:02d},5;{k},25;-{k},5" for k in range(50)]
    data = "\n".join(["Zeit;Weg;Kraft", *rows]).replace(";", delimiter).encode()
    source, values = read(tmp_path / "a.csv", data)
    assert source.layout.names == ("Zeit", "Weg", "Kraft")
    np.testing.assert_array_equal(values["Zeit"], np.arange(50.0))
    np.testing.assert_array_equal(values["Weg"], np.arange(50.0) + 0.25)


@pytest.mark.parametrize("irregular", ['"1.5"', "nan", "", "1_0"])
def test_irregular_cell_does_not_change_the_values_of_other_rows(
    irregular: str, tmp_path: Path
) -> None:
    random = np.random.default_rng(4).normal(size=(200, 2))
    rows = [f"{k},{a!r},{b:.3e},ok" for k, (a, b) in enumerate(random.tolist())]
    text = "\n".join(["t,F,v,state", *rows])
    _, regular = read(tmp_path / "a.csv", text.encode())
    first, *others = rows[100].split(",")
    changed = text.replace(rows[100], ",".join([first, irregular, *others[1:]]))
    _, values = read(tmp_path / "b.csv", changed.encode())
    keep = np.arange(200) != 100
    for name in ("t", "F", "v", "state"):
        np.testing.assert_array_equal(values[name][keep], regular[name][keep])
    np.testing.assert_array_equal(regular["F"], random[:, 0])


NUMBERS = st.floats(allow_nan=False, allow_infinity=False).map(repr)


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1), st.sampled_from("; \t"), st.booleans())
def test_numbers_of_regular_lines_have_the_bits_of_float(
    rows: list[tuple[str, str]], delimiter: str, comma: bool
) -> None:
    lines = [f" {a}{delimiter}word{delimiter}{b}\n" for a, b in rows]
    if comma:
        lines = [line.replace(".", ",") for line in lines]
    result = plain_columns(lines, Dialect(delimiter, ",."[not comma]), 3, [2, 0], [1])
    assert result is not None
    wanted = [[float(b) for _, b in rows], [float(a) for a, _ in rows]]
    np.testing.assert_array_equal(result[0], wanted)
    assert result[1] == [["word"] * len(rows)]


@pytest.mark.parametrize(
    "line", ["1;2\n", "1;2;3;4\n", "1;x;3\n", "1;;3\n", "1;inf;3\n", '1;"2";3\n', "1;1e999;3\n"]
)
def test_columns_with_an_irregular_line_are_not_parsed_as_regular(line: str) -> None:
    assert plain_columns(["1;2;3\n", line], Dialect(";", "."), 3, [0, 1, 2], []) is None
