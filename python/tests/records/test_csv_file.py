"""Reading runs from CSV: accepted formats, and the position that each error names."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf.records.csv_file import read_run

HEADER = "time_s,angle_rad,velocity_m_s,friction_n,load_n"
ROWS = [f"{0.02 * i:.3f},{0.1 * i:.5f},0.01,{0.5 - 0.1 * i:.4f},104.0" for i in range(12)]
DECIMAL_COMMA = [line.replace(",", ";").replace(".", ",") for line in [HEADER, *ROWS]]
Write = Callable[..., Path]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def write_lines(*lines: str, name: str = "a.csv", newline: str = "\n") -> Path:
        """Write lines to a file in a temporary folder."""
        path = tmp_path / name
        path.write_bytes("".join(line + newline for line in lines).encode())
        return path

    return write_lines


def changed(line: int, cell: int, text: str) -> list[str]:
    """Valid rows with one replaced cell; lines are counted from 1, including the header."""
    rows = [row.split(",") for row in ROWS]
    rows[line - 2][cell] = text
    return [",".join(row) for row in rows]


def test_run_read_from_csv_has_columns_file_stem_and_path(write: Write) -> None:
    path = write(HEADER, *ROWS, name="sweep.csv")
    run: Any = read_run(path)
    assert (run.name, len(run), run.path) == ("sweep", 12, path)
    assert list(run.columns()) == HEADER.split(",")
    assert (run.friction[11], run.columns()["angle_rad"][3]) == (-0.6, 0.3)


def test_csv_separators_quotes_comments_and_line_ends_do_not_change_the_run(write: Write) -> None:
    plain = read_run(write(HEADER, *ROWS))
    spaced = f" {HEADER.replace(',', ' , ')} "
    marked = write("# by hand", "", spaced, *ROWS, "", newline="\r\n", name="b.csv")
    marked.write_bytes(b"\xef\xbb\xbf" + marked.read_bytes())
    lines = [HEADER, *ROWS]
    semicolons = write(*(line.replace(",", ";") for line in lines), name="c.csv")
    tabs = write(*(line.replace(",", "\t") for line in lines), name="d.csv")
    quotes = write(*('"' + line.replace(",", '","') + '"' for line in lines), name="e.csv")
    for path in (marked, semicolons, tabs, quotes):
        assert read_run(path).to_csv() == plain.to_csv()


def test_unknown_csv_columns_are_read_if_all_their_cells_are_finite_numbers(write: Write) -> None:
    lines = [f"{i},{row},{i},up,{'' if i == 3 else i},inf,0.1" for i, row in enumerate(ROWS)]
    header = f",{HEADER},current_a,gear,patchy,broken,position_ref_m"
    run = read_run(write(header, *lines))
    assert list(run.extra) == ["current_a", "position_ref_m"]
    assert run.extra["current_a"].tolist() == list(range(12))


@pytest.mark.parametrize(
    ("old", "new", "column", "hint"),
    [
        ("velocity_m_s", "velocity_ms", "velocity_m_s", "velocity_ms"),
        ("friction_n", "force", "friction_n", "force"),
        ("time_s", "t", "time_s", '"t"'),
        ("friction_n", "pressure", "friction_n", "the header has time_s, angle_rad"),
        ("angle_rad", "angle_deg", "angle_deg", "angle_rad"),
        ("load_n", "load", "load", "load_n"),
        ("load_n", "friction_n", "friction_n", "rename or remove"),
    ],
)
def test_invalid_csv_header_is_reported_with_column_and_remedy(
    write: Write, old: str, new: str, column: str, hint: str
) -> None:
    path = write(HEADER.replace(old, new), *ROWS)
    error = input_error(read_run, path)
    assert (error.file, error.row, error.column) == (str(path), 1, column)
    assert hint in str(error.remedy)


@pytest.mark.parametrize(
    ("line", "cell", "text", "column", "fact"),
    [
        (12, 3, "abc", "friction_n", '"abc"'),
        (5, 1, "", "angle_rad", "empty"),
        (5, 3, "nan", "friction_n", "nan"),
        (6, 2, "-inf", "velocity_m_s", "-inf"),
        (4, 0, "0.020", "time_s", "repeats at 0.02"),
        (4, 0, "0.001", "time_s", "from 0.02 to 0.001"),
        (9, 4, "-104", "load_n", "-104.0 N"),
        (9, 4, "x" * 500, "load_n", "xxx..."),
    ],
)
def test_invalid_csv_cell_is_reported_with_its_row_and_column(
    write: Write, line: int, cell: int, text: str, column: str, fact: str
) -> None:
    path = write(HEADER, *changed(line, cell, text))
    error = input_error(read_run, path)
    assert (error.file, error.row, error.column) == (str(path), line, column)
    assert fact in error.problem
    assert len(str(error)) < len(str(path)) + 200


def test_row_of_an_invalid_cell_is_counted_with_comments_and_blank_lines(write: Write) -> None:
    rows = changed(5, 3, "abc")
    path = write("# rig 2", "", HEADER, *rows[:2], "", *rows[2:])
    assert input_error(read_run, path).row == 8


@pytest.mark.parametrize(
    ("lines", "row", "fact"),
    [
        ([HEADER, *ROWS[:4], "0.08,0.4,0.01", *ROWS[5:]], 6, "3 cells"),
        ([], None, "empty"),
        ([HEADER], None, "no samples"),
        ([HEADER, *ROWS[:9]], None, "9 samples"),
        (ROWS, 1, "numbers"),
        ([line.replace(",", " ") for line in [HEADER, *ROWS]], 1, "blanks"),
        (DECIMAL_COMMA, 2, "decimal comma"),
        ([HEADER, *ROWS[:3], '"0.06,0.3', *ROWS[4:]], 5, "quotation"),
        (["a\0b"], None, "binary"),
    ],
)
def test_malformed_csv_file_is_reported_with_cause_and_row(
    write: Write, lines: list[str], row: int | None, fact: str
) -> None:
    path = write(*lines)
    error = input_error(read_run, path)
    assert (error.file, error.row) == (str(path), row)
    assert fact in error.problem


def test_unreadable_run_file_is_reported_with_its_cause(write: Write, tmp_path: Path) -> None:
    good = write(HEADER, *ROWS, name="sweep.csv")
    assert input_error(read_run, tmp_path).file == str(tmp_path)
    assert "sweep.csv" in str(input_error(read_run, tmp_path / "sweeep.csv").remedy)
    assert "folder" in input_error(read_run, tmp_path / "no" / "x.csv").problem
    good.write_bytes(HEADER.encode() + b"\n1,\xff\n")
    assert input_error(read_run, good).row == 2
    good.write_bytes(HEADER.encode("utf-16"))
    assert "UTF-16" in input_error(read_run, good).problem


def test_missing_friction_column_is_accepted_only_if_not_required(write: Write) -> None:
    path = write("time_s,velocity_m_s", *(f"{i},0.1" for i in range(10)))
    assert read_run(path, need_friction=False).friction is None
    assert input_error(read_run, path).column == "friction_n"


def test_misspelt_friction_column_is_reported_even_if_not_required(write: Write) -> None:
    path = write("time_s,velocity_m_s,friction", *(f"{i},0.1,1" for i in range(10)))
    assert "friction_n" in str(input_error(read_run, path, need_friction=False).remedy)


def cells(count: int, empty: int, value: str) -> list[str]:
    """Cells of a column whose first cells are empty."""
    return [" "] * empty + [value] * (count - empty)


@pytest.mark.parametrize(("samples", "empty"), [(100, 10), (400, 20)])
def test_csv_column_with_ten_cells_and_five_percent_empty_has_a_separate_clock(
    write: Write, samples: int, empty: int
) -> None:
    def path_with(empty: int) -> Path:
        rows = [f"{i},1.5,{cell}" for i, cell in enumerate(cells(samples, empty, "2.5"))]
        return write("time_s,velocity_m_s,friction_n", *rows)

    assert input_error(read_run, path_with(empty - 1)).column == "friction_n"
    run: Any = read_run(path_with(empty))
    assert run.read["friction_n"].tolist() == [False] * empty + [True] * (samples - empty)
    assert set(run.friction.tolist()) == {2.5}


def test_empty_speed_cells_are_accepted_only_in_rows_with_a_force_reading(write: Write) -> None:
    speed, force = cells(100, 3, "1.5"), cells(100, 60, "7")
    rows = [f"{i},{speed[i]},{force[i]}" for i in range(100)]
    path = write("time_s,velocity_m_s,friction_n", *rows)
    assert input_error(read_run, path).column == "velocity_m_s"
    rows = [f"{i},{speed[i]},{force[99 - i]}" for i in range(100)]
    path = write("time_s,velocity_m_s,friction_n", *rows)
    assert set(read_run(path).read) == {"velocity_m_s", "friction_n"}


def test_csv_temperature_column_is_accepted_if_empty_or_with_gaps(write: Write) -> None:
    rows = [f"{0.1 * i},1.0,2.0," for i in range(12)]
    assert read_run(write("time_s,velocity_m_s,friction_n,temperature_c", *rows)).read == {}
    rows[4] += "21.5"
    run = read_run(write("time_s,velocity_m_s,friction_n,temperature_c", *rows))
    np.testing.assert_array_equal(run.temperature_c, 21.5)
    assert [finding.kind for finding in run.reading] == ["gaps"]


def test_irregular_file_has_the_same_bits_as_a_regular_one(tmp_path: Path) -> None:
    random = np.random.default_rng(3)
    t = np.arange(0.0, 4.0, 0.02)
    rows = np.column_stack([t, random.normal(size=len(t)), 1e9 * random.normal(size=len(t))])
    lines = [",".join(map(repr, row)) for row in rows.tolist()]
    header = "time_s,velocity_m_s,friction_n"
    (tmp_path / "regular.csv").write_text("\n".join([header, *lines, ""]))
    # A blank line and quotation marks are allowed, but not regular.
    first, _, rest = lines[7].partition(",")
    lines[7:8] = ["", f'"{first}",{rest}']
    (tmp_path / "irregular.csv").write_text("\n".join([header, *lines, ""]))
    regular, irregular = (
        read_run(tmp_path / f"{name}.csv").columns() for name in ("regular", "irregular")
    )
    assert list(regular) == list(irregular)
    for name, values in regular.items():
        assert np.array_equal(values, irregular[name]), name
