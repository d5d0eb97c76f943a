"""Checks of arguments of public functions and of values in TOML files."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf import Rig, Run
from jbf.records.arguments import (
    by_name,
    check_callable,
    check_run,
    list_of_runs,
    names,
    numbers,
    of_kind,
    one_of,
    one_run,
    the_rig,
    whole_number,
)
from jbf.records.toml_file import number, positive, read_toml, refuse_unknown, table

TIME_S = np.linspace(0.0, 1.0, 20)
RUN = Run.from_arrays(TIME_S, 0.1 + TIME_S, np.ones(20), name="sine")


def test_arguments_of_the_required_kind_are_accepted_and_returned() -> None:
    rig = Rig()
    assert the_rig(rig) is rig
    assert one_run(RUN) is RUN
    assert of_kind(RUN, Run, "the run", "give one") is RUN
    check_callable(None, "progress")
    check_callable(print, "progress")
    assert one_of("b", iter(["a", "b"]), "clock") == "b"
    assert names(iter(["a", "b"]), "effects") == ("a", "b")
    given = {"a": 1}
    assert by_name(given, "start") == given
    assert by_name(given, "start") is not given


@pytest.mark.parametrize(
    ("check", "arguments", "remedy"),
    [
        (the_rig, (None,), "jbf.Rig"),
        (the_rig, ("r.toml",), 'jbf.read_rig("r.toml")'),
        (one_run, ("a.csv",), 'jbf.read_run("a.csv")'),
        (one_run, ([RUN],), "one of them"),
        (list_of_runs, (RUN,), "[run]"),
        (list_of_runs, (Path("a"),), 'jbf.read_runs("a")'),
        (list_of_runs, (Rig(),), "the rig first"),
        (list_of_runs, ({"a": RUN},), "list of jbf.Run"),
        (list_of_runs, ([RUN, "b"],), 'jbf.read_run("b")'),
        (list_of_runs, ([RUN, RUN, 3],), "list of jbf.Run"),
        (names, ("a", "effects"), 'effects=["a"]'),
        (names, ("", "effects"), "effects=[]"),
        (names, (["a", 3], "effects"), "names"),
        (check_callable, (3, "progress"), "function"),
        (one_of, ("journl", ["journal", "thesis"], "clock"), '"journal"'),
        (one_of, (3, ["a", "b"], "clock"), "a, b"),
        (by_name, ([1], "start"), "start="),
        (numbers, (None, "speeds"), "numbers"),
        (numbers, (["a"], "speeds"), "numbers"),
    ],
)
def test_argument_of_the_wrong_kind_is_rejected_with_a_remedy(
    check: Any, arguments: tuple[Any, ...], remedy: str
) -> None:
    assert remedy in str(input_error(check, *arguments).mend)


def test_list_of_runs_accepts_any_iterable_and_checks_each_run() -> None:
    given = [RUN, RUN]
    assert list_of_runs(given) == list_of_runs(iter(given)) == list_of_runs((RUN, RUN)) == given
    assert list_of_runs(given) is not given
    wrong: Any = [1.0]
    assert input_error(list_of_runs, [RUN, replace(RUN, friction_n=wrong)]).column == "friction_n"


@pytest.mark.parametrize(
    ("column", "values"),
    [
        ("friction_n", [1.0] * 20),
        ("friction_n", np.ones(20, dtype=np.float32)),
        ("friction_n", np.ones((20, 1))),
        ("friction_n", np.ma.masked_array(np.ones(20), mask=[True] + [False] * 19)),
        ("friction_n", np.array([*np.ones(19), np.nan])),
        ("velocity_m_s", [1]),
    ],
)
@pytest.mark.parametrize("speed_recorded", [True, False])
def test_invalid_column_of_a_directly_constructed_run_is_reported(
    column: str, values: Any, speed_recorded: bool
) -> None:
    check_run(RUN)
    wrong = replace(RUN, **{column: values}, speed_recorded=speed_recorded)
    error = input_error(check_run, wrong)
    assert (error.file, error.column) == ("sine", column)


@pytest.mark.parametrize(("value", "least"), [(0, 0), (3, 3), (np.int64(7), 2), (-1, -1)])
def test_integer_not_below_its_minimum_is_returned_as_int(value: Any, least: int) -> None:
    found = whole_number(value, "n", least)
    assert (found, type(found)) == (int(value), int)


@pytest.mark.parametrize(
    ("value", "least"),
    [(-1, 0), (2, 3), (True, 0), (1.0, 0), (Fraction(1, 2), 0), ("1", 0), (None, 0)],
)
def test_whole_number_below_its_minimum_or_of_another_type_is_rejected(
    value: object, least: int
) -> None:
    assert str(least) in str(input_error(whole_number, value, "n", least).mend)


def test_numbers_become_a_contiguous_array_of_the_requested_type_and_dimension() -> None:
    assert numbers([[1, 2], [3, 4]], "speeds").shape == (2, 2)
    assert numbers([1, 0], "mask", np.bool_).dtype == np.bool_
    assert numbers(np.arange(10.0)[::2], "speeds").flags.c_contiguous
    assert numbers([1.0], "speeds", flat=True).tolist() == [1.0]
    assert "(1, 1)" in input_error(numbers, [[1.0]], "speeds", flat=True).problem


def test_toml_number_is_returned_as_float_and_other_values_are_rejected() -> None:
    values: list[Any] = [1, 2.5, np.float32(0.5), float("inf")]
    assert [number(value, "k") for value in values] == [1.0, 2.5, 0.5, float("inf")]
    for value in (True, "1", [1], 10**400):
        assert input_error(number, value, "k").key == "k"


def test_positive_number_must_lie_between_1e_minus_12_and_1e12() -> None:
    assert [positive(value, "k") for value in (1e-12, 1.0, 1e12)] == [1e-12, 1.0, 1e12]
    for value in (0.0, -1, float("inf"), float("nan"), 0.99e-12, 1.01e12):
        assert input_error(positive, value, "k").key == "k"


def test_toml_value_that_is_not_a_table_is_rejected() -> None:
    given = {"a": 1}
    assert table(given, "rig") is given
    assert input_error(table, 3, "rig").key == "rig"


def test_unknown_key_is_reported_with_the_nearest_known_key() -> None:
    refuse_unknown(["a"], iter(["a", "b"]))
    error = input_error(refuse_unknown, ["radius", "x"], iter(["radius_m"]), "bearing.")
    assert error.key == "bearing.radius"
    assert "radius_m" in str(error.mend)


def test_toml_syntax_error_is_reported_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("a = 1\n[b]\nc = 2.5\n")
    assert read_toml(path) == {"a": 1, "b": {"c": 2.5}}
    for text, row in (("a = 1\nb = \n", 2), ("a = 1\nb", 2), ("a = 1\na = 2\n", 2)):
        path.write_text(text)
        error = input_error(read_toml, path)
        assert error.file == str(path)
        assert error.row == row
