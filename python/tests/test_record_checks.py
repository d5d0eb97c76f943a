"""What columns and channels must hold, and columns of frames: both sides of each threshold."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from jbf import InputError
from jbf.records.channels import filled, of_motion, side_by_side, with_own_clock
from jbf.records.checks import (
    COLUMNS,
    LARGEST,
    MIN_SAMPLES,
    SHORTEST_S,
    as_array,
    check_columns,
    frozen,
    listed,
)
from jbf.records.frames import columns_of

TIME = np.arange(12.0)


def refusal(ask: Callable[..., Any], *given: Any, **named: Any) -> str:
    """The one line of an error."""
    with pytest.raises(InputError) as caught:
        ask(*given, **named)
    return str(caught.value)


def changed(column: str, index: int, value: float, **more: Any) -> dict[str, Any]:
    """Good columns with one cell replaced."""
    columns = {"time_s": TIME, "friction_n": np.ones(12), "load_n": np.full(12, 5.0),
               "temperature_c": np.full(12, 20.0), "own": np.zeros(12)} | more  # fmt: skip
    values = columns[column].copy()
    values[index] = value
    return columns | {column: values}


@pytest.mark.parametrize(
    ("column", "index", "value", "said"),
    [
        ("friction_n", 3, np.nan, "sample 3: nan is not a finite number; correct the cell or drop"),
        ("own", 0, np.inf, "sample 0: inf is not a finite number"),
        ("temperature_c", 11, -np.inf, "sample 11: -inf is not a finite number"),
        ("friction_n", 2, -1.01 * LARGEST, "sample 2: -1010000000000.0 is beyond what any machine "
         "does; correct the cell, or the unit"),
        ("load_n", 4, 0.0, "sample 4: a load of 0.0 N is not above zero; correct the cell"),
        ("time_s", 5, 4.0, "sample 5: time repeats at 4.0; sort the rows and drop repeats; one "
         "file is one run"),
        ("time_s", 5, 3.5, "sample 5: time runs back from 4.0 to 3.5; sort the rows"),
        ("time_s", 1, 0.9 * SHORTEST_S, "sample 1: a step of 9e-13 s is shorter than any logger's; "
         "give the time in seconds"),
    ],
)  # fmt: skip
def test_a_cell_that_no_run_has(column: str, index: int, value: float, said: str) -> None:
    """Named by its column and its sample, or by the line of its file."""
    columns = changed(column, index, value)
    line = refusal(check_columns, "a", columns, None, None)
    assert line.startswith(f"a, column {column}: {said}")
    rows = list(range(2, 14))
    in_file = refusal(check_columns, "a", columns, Path("f.csv"), rows)
    _, _, problem = said.partition(": ")
    assert in_file.startswith(f"f.csv, row {index + 2}, column {column}: {problem}")
    assert refusal(check_columns, "a", columns, Path("f.csv"), None).startswith("a, column")


@pytest.mark.parametrize(
    ("column", "index", "value"),
    [
        ("friction_n", 2, LARGEST),
        ("friction_n", 2, -LARGEST),
        ("own", 2, 1e300),
        ("temperature_c", 2, np.nan),
        ("load_n", 2, 1e-300),
        ("time_s", 1, 1.1 * SHORTEST_S),
    ],
)
def test_a_cell_that_a_run_may_have(column: str, index: int, value: float) -> None:
    """The ends of each range; a gap of a temperature; a column of one's own may be large."""
    check_columns("a", changed(column, index, value), None, None)


def test_columns_are_of_one_length_and_not_too_short() -> None:
    """Ten samples are a run, nine are none; a temperature that was never read is none."""
    check_columns("a", {"time_s": TIME[:10]}, None, None)
    assert MIN_SAMPLES == 10
    assert refusal(check_columns, "a", {"time_s": TIME[:9]}, None, None) == (
        "a: has 9 samples; a run needs at least 10"
    )
    one = {"time_s": TIME, "friction_n": TIME[:1]}
    assert refusal(check_columns, "a", one, None, None) == (
        "a, column friction_n: has 1 sample where time_s has 12; "
        "give every column one value a sample"
    )
    never = {"time_s": TIME, "temperature_c": np.full(12, np.nan)}
    assert "sample 0: nan" in refusal(check_columns, "a", never, None, None)
    check_columns("a", {"time_s": TIME, "own": 1e13 * TIME}, None, None)
    assert "beyond" in refusal(
        check_columns, "a", {"time_s": TIME, "own": 1e13 * TIME}, None, None, (*COLUMNS, "own")
    )


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (["a"], "holds <U1, not numbers; give one number a sample, shape (N,)"),
        ([1j], "holds complex128, not numbers"),
        (np.array([1.0, "b"], dtype=object), 'holds the text "b", not numbers'),
        (np.array([b"c"], dtype=object), "holds the text"),
        ([[1.0], [1.0, 2.0]], "is not an array of numbers"),
        ([[1.0]], "has shape (1, 1)"),
        (1.0, "has shape ()"),
        (np.array([{}], dtype=object), "is not an array of numbers"),
        (np.array(["2020-01-01"], dtype="datetime64[D]"), "holds datetime64[D], not numbers"),
        ([10**400], "is not an array of numbers"),
        (np.ma.masked_array([1.0, 2.0], mask=[False, True]), "has masked samples; leave them out"),
        ([1.0, np.ma.masked], "has masked samples"),
        ((np.ma.masked,), "has masked samples"),
    ],
)
def test_what_is_no_column(values: Any, said: str) -> None:
    """Text, dates, complex numbers, tables, masks."""
    assert refusal(as_array, values, "c", "a").startswith(f"a, column c: {said}")


def test_what_is_a_column() -> None:
    """Numbers of any real kind, as float64 that nobody can write to, and a copy."""
    kinds: list[Any] = [np.uint8, np.float32, object]
    arrays = [np.array([1, 2], dtype=kind) for kind in kinds]
    given: list[Any] = [[1, 2], (True, False), *arrays, np.ma.masked_array([1.0], mask=[False])]
    for values in given:
        found = as_array(values, "c", "a")
        assert found.tolist() == [float(x) for x in values]
        assert found.dtype == np.float64
        assert not found.flags.writeable
    own = np.zeros(3)
    kept = frozen(own)
    own[0] = 1.0
    assert kept[0] == 0.0
    assert kept.flags.c_contiguous
    assert not kept.flags.writeable


def test_a_list_of_names_is_not_too_long() -> None:
    """Empty names are left out; what does not fit is three dots."""
    assert listed(["a", "", "b"]) == "a, b"
    long = listed(["column"] * 40)
    assert long.endswith(" ...")
    assert 150 < len(long) <= 160


FAST, SLOW = np.arange(0.0, 3.0, 0.1), np.arange(0.05, 2.5, 0.2)


def test_channels_stand_side_by_side_while_the_motion_lasts() -> None:
    """At all instants of all, straight lines between readings; where each was read."""
    columns, read = side_by_side(
        {"velocity_m_s": (FAST, 2.0 * FAST), "friction_n": (SLOW - 0.4, SLOW)}, "a"
    )
    time = columns["time_s"]
    assert list(columns) == ["time_s", "velocity_m_s", "friction_n"]
    assert time.tolist() == sorted({*FAST.tolist(), *(SLOW[SLOW >= 0.4] - 0.4).tolist()})
    np.testing.assert_allclose(columns["velocity_m_s"], 2.0 * time)
    inside = time < SLOW[-1] - 0.4
    np.testing.assert_allclose(columns["friction_n"][inside], time[inside] + 0.4)
    assert set(read) == {"velocity_m_s", "friction_n"}
    assert time[read["velocity_m_s"]].tolist() == FAST.tolist()
    assert time[read["friction_n"]].tolist() == (SLOW[SLOW >= 0.4] - 0.4).tolist()
    same, none = side_by_side({"velocity_m_s": (FAST, FAST), "own": (FAST, FAST)}, "a")
    assert none == {}
    assert same["time_s"].tolist() == FAST.tolist()


def test_the_motion_lasts_where_all_of_its_channels_do() -> None:
    """From the last beginning to the first end of those that tell it."""
    columns, _ = side_by_side(
        {"velocity_m_s": (FAST, FAST), "position_m": (FAST + 0.55, FAST), "own": (FAST - 9, FAST)},
        "a",
    )
    assert columns["time_s"][0] == pytest.approx(0.55)
    assert columns["time_s"][-1] == FAST[-1]


@pytest.mark.parametrize(
    ("channels", "said"),
    [
        ({"friction_n": (FAST, FAST)}, "a, column velocity_m_s: is missing, and no position tells "
         "the motion; give one of velocity_m_s, position_m, angle_rad"),
        ({"velocity_m_s": (FAST, FAST[1:])}, "a, column velocity_m_s: has 29 values at 30 instants;"
         " give one a reading"),
        ({"friction_n": (FAST[:9], FAST[:9])}, "a, column friction_n: has 9 readings; a run needs "
         "at least 10"),
        ({"own": ([], [])}, "a, column own: is not all finite numbers; leave out what was not"),
        ({"own": ([np.nan], [1.0])}, "a, column own: is not all finite numbers"),
        ({"own": ([1.0], [np.inf])}, "a, column own: is not all finite numbers"),
        ({"own": ([1.0, 1.0], [1.0, 1.0])}, "a, column own: has a time that repeats or runs back; "
         "sort its readings and drop repeats"),
        ({"own": ([1.0, 0.5], [1.0, 1.0])}, "a, column own: has a time that repeats or runs back"),
        ({"own": (["x"], [1.0])}, "a, column time_s of own: holds <U1"),
    ],
)  # fmt: skip
def test_what_is_no_channel(channels: Any, said: str) -> None:
    """Its length, its clock, its values; what tells no motion."""
    assert refusal(side_by_side, channels, "a").startswith(said)


def test_a_channel_that_nothing_needs_may_be_short() -> None:
    """One reading of it is enough; of the motion and of friction it is not."""
    columns, read = side_by_side({"angle_rad": (FAST, FAST), "own": ([0.1], [7.0])}, "a")
    assert set(columns["own"]) == {7.0}
    assert read["own"].sum() == 1
    ten = side_by_side({"velocity_m_s": (FAST, FAST), "friction_n": (FAST[:10], FAST[:10])}, "a")
    assert ten[1]["friction_n"].sum() == 10


@pytest.mark.parametrize(
    ("samples", "gaps", "own"),
    [(100, 9, False), (100, 10, True), (400, 19, False), (400, 20, True)],
)
def test_a_column_of_which_much_is_missing_has_a_clock_of_its_own(
    samples: int, gaps: int, own: bool
) -> None:
    """A twentieth, and ten samples; less are gaps, and stay."""
    time, values = np.arange(float(samples)), np.ones(samples)
    values[:gaps] = np.nan
    clock, read = with_own_clock(time, values)
    assert len(clock) == len(read) == (samples - gaps if own else samples)
    assert clock[0] == (gaps if own else 0)
    whole = with_own_clock(time, np.ones(samples))
    assert whole[0] is time


def test_gaps_are_straight_lines_and_the_motions_clock_is_its_quickest() -> None:
    """None where all of it was read everywhere."""
    there = np.array([True, False, False, True])
    time, values = np.array([0.0, 1.0, 3.0, 4.0]), np.array([0.0, 9.0, 9.0, 8.0])
    assert filled(time, values, there).tolist() == [0.0, 2.0, 6.0, 8.0]
    more = np.array([True, True, False, True])
    assert of_motion({"friction_n": there}) is None
    assert of_motion({}) is None
    assert of_motion({"velocity_m_s": there, "angle_rad": more, "own": ~there}) is more
    assert of_motion({"velocity_m_s": more, "position_m": there}) is more


class Frame:
    """A data frame, as far as names and columns go."""

    def __init__(self, columns: dict[str, Any], **more: Any) -> None:
        self.columns = list(columns)
        self._columns = columns
        self.__dict__.update(more)

    def __getitem__(self, name: str) -> Any:
        return self._columns[name]


def test_columns_of_numbers_are_taken_and_others_left() -> None:
    """Nulls are nan; text and dates are no numbers; truth is."""
    found = columns_of(
        {"a": [1, 2], "text": ["x", "y"], "nulls": np.array([1.5, None], dtype=object),
         "words": np.array(["x", None], dtype=object), "truth": [True, False],
         "dates": np.array(["2020-01-01"] * 2, dtype="datetime64[D]"),
         "mixed": np.array([1.0, {}], dtype=object),
         "ragged": np.array([[1.0], [1.0, 2.0]], dtype=object)},
        "r",
    )  # fmt: skip
    assert {n: v.dtype.kind for n, v in found.items()} == {"a": "f", "nulls": "f", "truth": "f"}
    assert found["a"].tolist() == [1.0, 2.0]
    np.testing.assert_array_equal(found["nulls"], [1.5, np.nan])
    assert found["truth"].tolist() == [1.0, 0.0]


def test_an_index_called_time_is_a_column_where_there_is_none() -> None:
    """It stands first; a column of that name comes before it."""
    index = SimpleNamespace(name="time_s", to_numpy=lambda: np.array([0.0, 1.0]))
    assert list(columns_of(Frame({"a": [1, 2]}, index=index), "r")) == ["time_s", "a"]
    both = columns_of(Frame({"a": [1, 2], "time_s": [5, 6]}, index=index), "r")
    assert both["time_s"].tolist() == [5.0, 6.0]
    other = SimpleNamespace(name="row", to_numpy=lambda: np.array([0.0, 1.0]))
    assert list(columns_of(Frame({"a": [1, 2]}, index=other), "r")) == ["a"]


def test_what_has_no_columns_by_name_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """Unless it exports itself by Arrow and pyarrow is there."""
    mend = "give a pandas or polars frame, an Arrow table or a dict of arrays"
    for wrong in (3, SimpleNamespace(columns=[1, 2]), SimpleNamespace(columns=["a"]),
                  SimpleNamespace(columns=lambda: ["a"])):  # fmt: skip
        name = type(wrong).__name__
        assert refusal(columns_of, wrong, "r") == f"r: {name} has no columns by name; {mend}"

    class Exports:
        def __arrow_c_stream__(self) -> None:
            """Never asked for."""

    class Arrow:
        @staticmethod
        def table(frame: object) -> Frame:
            assert isinstance(frame, Exports)
            return Frame({"a": [1.0]})

    monkeypatch.setattr(importlib, "import_module", lambda name: Arrow)
    assert columns_of(Exports(), "r")["a"].tolist() == [1.0]

    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    assert refusal(columns_of, Exports(), "r") == (
        "r: Exports exports itself by Arrow alone, and pyarrow is missing; "
        "pip install pyarrow, or give a frame or a dict of arrays"
    )
