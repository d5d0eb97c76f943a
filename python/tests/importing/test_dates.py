"""Dates and times of day in the notations of loggers, against the calendar of Python."""

from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from input_errors import input_error
from jbf.importing.formats.dates import (
    DAY_FIRST,
    MONTH_FIRST,
    NO_INSTANT,
    Instants,
    as_date,
    day_or_month_first,
    is_instant,
    seconds_since,
)
from jbf.importing.formats.registry import open_source

EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
MOMENTS = st.datetimes(datetime(1970, 1, 2), datetime(2099, 12, 31))


def ns(moment: datetime) -> int:
    """Nanoseconds since 1970 by the calendar of the standard library."""
    since = moment.replace(tzinfo=moment.tzinfo or timezone.utc) - EPOCH
    return since // timedelta(microseconds=1) * 1000


def parsed(cell: str, order: str = DAY_FIRST) -> int:
    return int(Instants(order).parse([cell], [False])[0])


@given(MOMENTS)
def test_parsed_date_agrees_with_the_standard_library_in_every_notation(moment: datetime) -> None:
    fraction = f"{moment.microsecond:06d}"
    day, clock = f"{moment:%d.%m.%Y}", f"{moment:%H:%M:%S}"
    for cell in (
        moment.isoformat(),
        f"{day} {clock},{fraction}",
        f"{moment:%Y/%m/%d} {clock}.{fraction}",
        f"{moment:%d/%m/%Y}  {moment:%I:%M:%S}.{fraction} {moment:%p}",
        f"{moment:%Y-%m-%d}T{clock}.{fraction}Z",
    ):
        assert parsed(cell) == ns(moment), cell
    american = f"{moment:%m/%d/%Y} {moment:%I:%M:%S}.{fraction} {moment:%p}"
    assert parsed(american, MONTH_FIRST) == ns(moment)


@given(st.lists(st.tuples(MOMENTS, st.integers(0, 3)), max_size=30), st.data())
def test_parsed_column_of_mixed_notations_equals_its_separately_parsed_cells(
    moments: list[tuple[datetime, int]], data: st.DataObject
) -> None:
    formats = ("%Y-%m-%dT%H:%M:%S.%f", "%d.%m.%y %H:%M", "%d-%b-%Y %I:%M:%S %p", "%Y/%m/%d")
    cells = [moment.strftime(formats[notation]) for moment, notation in moments]
    empty = [data.draw(st.booleans()) for _ in cells]
    wanted = [NO_INSTANT if e else parsed(c) for c, e in zip(cells, empty, strict=True)]
    assert Instants().parse(cells, empty).tolist() == wanted


@pytest.mark.parametrize(
    ("cell", "month"),
    [
        ("24-Nov-2026 13:05:07", 11), ("24 November 2026 13:05:07", 11),
        ("24-Mai-2026 13:05:07", 5), ("24-Mär-2026 13:05:07", 3), ("24 déc. 2026 13:05:07", 12),
        ("24-OKT-2026 13:05:07", 10),
    ],
)  # fmt: skip
def test_date_with_a_month_name_is_parsed_in_every_notation(cell: str, month: int) -> None:
    assert parsed(cell) == ns(datetime(2026, month, 24, 13, 5, 7))
    assert is_instant(cell)


@pytest.mark.parametrize(
    ("cell", "hour"),
    [
        ("12:00:00 AM", 0), ("12:30:00 a.m.", 0.5), ("01:00:00 AM", 1),
        ("11:59:59 am", 12 - 1 / 3600), ("12:00:00 PM", 12), ("01:00:00 p.m.", 13),
        ("11:15 PM", 23.25),
    ],
)  # fmt: skip
def test_twelve_hour_time_is_parsed_with_12_am_as_midnight(cell: str, hour: float) -> None:
    assert parsed(cell) == round(hour * 3600) * 10**9


@given(MOMENTS, st.integers(-12 * 4, 14 * 4))
def test_local_time_with_offset_is_parsed_as_its_instant(moment: datetime, quarters: int) -> None:
    zone = timezone(timedelta(minutes=15 * quarters))
    local = moment.replace(microsecond=0, tzinfo=timezone.utc).astimezone(zone)
    offset = local.strftime("%z")
    for written in (offset, f"{offset[:3]}:{offset[3:]}"):
        assert parsed(f"{local:%Y-%m-%d %H:%M:%S}{written}") == ns(local)


def test_time_of_day_after_midnight_is_assigned_to_the_next_day() -> None:
    cells = ["23:59:58", "23:59:59.5", "", "00:00:01", "12:00:01", "00:00:00"]
    result = Instants().parse(cells, [not cell for cell in cells])
    day = 86_400 * 10**9
    assert result[:2].tolist() == [day - 2 * 10**9, day - 5 * 10**8]
    assert result[2:].tolist() == [NO_INSTANT, day + 10**9, day + day // 2 + 10**9, 2 * day]
    seconds = seconds_since(result, int(result[0]))
    np.testing.assert_array_equal(seconds[:4], [0.0, 1.5, np.nan, 3.0])


def test_time_of_day_that_steps_back_by_one_second_stays_on_the_same_day() -> None:
    back = Instants().parse(["10:00:01", "10:00:00"], [False, False])
    assert back[1] - back[0] == -(10**9)


@pytest.mark.parametrize(
    "cell",
    [
        "2026-02-30", "31.04.2026 10:00", "noon", "10", "2026-13-01", "12:00:00 XM", "1.2",
        "24-Foo-2026", "24 jui 2026", "9999-01-01", "२०२६-11-24", "12:00:00." + 60 * "0",
        "13:05:00,000;12,125;-1234,50",
    ],
)  # fmt: skip
def test_cell_without_a_valid_date_or_time_is_refused_with_its_row(cell: str) -> None:
    error = input_error(Instants().parse, ["2026-01-01", cell, "-"], [False, False, False])
    assert error.row == 1


@pytest.mark.parametrize(
    ("cells", "order"),
    [
        (["13/02/2026", "01/02/2026"], DAY_FIRST),
        (["02/13/2026", "02/01/2026"], MONTH_FIRST),
        (["01.02.2026", "02.03.2026"], DAY_FIRST),
        (["01/02/2026", "02/03/2026"], None),
        (["01/02/2026 10:00", "01/02/2026 11:00"], DAY_FIRST),
        (["2026-01-02", "10:00:00"], DAY_FIRST),
    ],
)
def test_order_of_day_and_month_is_inferred_if_unambiguous(cells: list[str], order: str) -> None:
    assert day_or_month_first(cells) == order


def test_time_of_day_without_a_date_is_not_written_as_a_date() -> None:
    assert as_date(3600 * 10**9) is None
    assert as_date(ns(datetime(2026, 11, 24, 12, 30))) == "2026-11-24T12:30:00.000000000"


def test_year_of_two_digits_in_a_date_is_read_as_a_year_after_2000() -> None:
    assert parsed("24.11.26") == ns(datetime(2026, 11, 24))


def test_file_times_of_windows_keep_their_ticks(tmp_path: Path) -> None:
    first = 132_959_733_843_760_001
    lines = ["stamp;force [N]", *(f"{first + 12_345 * k};{k}.5" for k in range(50))]
    (tmp_path / "a.csv").write_text("\n".join(lines))
    with open_source(tmp_path / "a.csv") as source:
        (table,) = source.tables
        head = source.head(table)
    assert table.start == "2022-05-02T13:56:24.376000100"
    np.testing.assert_allclose(head["stamp"], 12_345e-7 * np.arange(50), rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("word", "month"),
    [("Jan", 1), ("ene", 1), ("gen", 1), ("juin", 6), ("juillet", 7), ("Mär", 3), ("dic", 12)],
)
def test_month_name_is_parsed_as_its_number(word: str, month: int) -> None:
    assert parsed(f"24-{word}-2026 10:00:00") == ns(datetime(2026, month, 24, 10))


def test_quoted_dates_have_the_same_values_as_unquoted_dates(tmp_path: Path) -> None:
    rows = [f"2026-01-24 10:00:{i / 10:06.3f},{i}.5,{i}" for i in range(40)]
    plain = "\n".join(["Time,Force [N],Pos [mm]", *rows]) + "\n"
    lines = [["Time", "Force [N]", "Pos [mm]"], *(row.split(",") for row in rows)]
    quoted = "\n".join(",".join(f'"{cell}"' for cell in line) for line in lines) + "\n"
    seen = []
    for name, text in (("plain.csv", plain), ("quoted.csv", quoted)):
        (tmp_path / name).write_text(text)
        with open_source(tmp_path / name) as source:
            (block,) = source.blocks(source.tables[0], ["Time", "Force [N]"])
        seen.append(block)
    for key in seen[0]:
        np.testing.assert_array_equal(seen[0][key], seen[1][key])
