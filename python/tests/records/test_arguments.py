"""Checks of arguments of public functions and of values in TOML files."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from input_errors import input_error
from jbf import Rig, Run
from jbf.records import arguments
from jbf.records.checks import attribute
from jbf.records.toml_file import number, positive, read_toml, refuse_unknown, table

TIME_S = np.linspace(0.0, 1.0, 20)
RUN = Run.from_arrays(TIME_S, 0.1 + TIME_S, np.ones(20), name="sine")


def test_arguments_of_the_required_kind_are_accepted_and_returned() -> None:
    rig = Rig()
    assert arguments.the_rig(rig) is rig
    assert arguments.one_run(RUN) is RUN
    assert arguments.of_kind(RUN, Run, "the run", "give one") is RUN
    arguments.check_callable(None, "progress")
    arguments.check_callable(print, "progress")
    assert arguments.one_of("b", iter(["a", "b"]), "clock") == "b"
    assert arguments.names(iter(["a", "b"]), "effects") == ("a", "b")
    given = {"a": 1}
    assert arguments.by_name(given, "start") == given
    assert arguments.by_name(given, "start") is not given


@pytest.mark.parametrize(
    ("check", "given", "remedy"),
    [
        (arguments.the_rig, (None,), "jbf.Rig"),
        (arguments.the_rig, ("r.toml",), 'jbf.read_rig("r.toml")'),
        (arguments.one_run, ("a.csv",), 'jbf.read_run("a.csv")'),
        (arguments.one_run, ([RUN],), "one of them"),
        (arguments.list_of_runs, (RUN,), "[run]"),
        (arguments.list_of_runs, (Path("a"),), 'jbf.read_runs("a")'),
        (arguments.list_of_runs, (Rig(),), "the rig first"),
        (arguments.list_of_runs, ({"a": RUN},), "list of jbf.Run"),
        (arguments.list_of_runs, ([RUN, "b"],), 'jbf.read_run("b")'),
        (arguments.list_of_runs, ([RUN, RUN, 3],), "list of jbf.Run"),
        (arguments.names, ("a", "effects"), 'effects=["a"]'),
        (arguments.names, ("", "effects"), "effects=[]"),
        (arguments.names, (["a", 3], "effects"), "names"),
        (arguments.check_callable, (3, "progress"), "function"),
        (arguments.one_of, ("journl", ["journal", "thesis"], "clock"), '"journal"'),
        (arguments.one_of, (3, ["a", "b"], "clock"), "a, b"),
        (arguments.by_name, ([1], "start"), "start="),
        (arguments.numbers, (None, "speeds"), "numbers"),
        (arguments.numbers, (["a"], "speeds"), "numbers"),
    ],
)
def test_wrong_argument_type_is_rejected_with_a_remedy(check: Any, given: Any, remedy: str) -> None:
    assert remedy in str(input_error(check, *given).remedy)


def test_list_of_runs_accepts_any_iterable_and_checks_each_run() -> None:
    given = [RUN, RUN]
    for iterable in (given, iter(given), (RUN, RUN)):
        assert arguments.list_of_runs(iterable) == given
    assert arguments.list_of_runs(given) is not given
    wrong: Any = [1.0]
    error = input_error(arguments.list_of_runs, [RUN, replace(RUN, friction=wrong)])
    assert error.column == "friction_n"


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
def test_invalid_column_of_a_directly_created_run_is_reported(column: str, values: Any) -> None:
    arguments.check_run(RUN)
    for speed_recorded in (True, False):
        wrong = replace(RUN, **{attribute(column): values}, speed_recorded=speed_recorded)
        error = input_error(arguments.check_run, wrong)
        assert (error.file, error.column) == ("sine", column)


@pytest.mark.parametrize(("value", "least"), [(0, 0), (3, 3), (np.int64(7), 2), (-1, -1)])
def test_integer_at_or_above_its_minimum_is_returned_as_int(value: Any, least: int) -> None:
    integer = arguments.checked_integer(value, "n", least)
    assert (integer, type(integer)) == (int(value), int)


@pytest.mark.parametrize(
    ("value", "least"),
    [(-1, 0), (2, 3), (True, 0), (1.0, 0), (Fraction(1, 2), 0), ("1", 0), (None, 0)],
)
def test_integer_below_its_minimum_or_of_another_type_is_rejected(value: Any, least: int) -> None:
    assert str(least) in str(input_error(arguments.checked_integer, value, "n", least).remedy)


def test_numeric_argument_becomes_a_contiguous_array_of_the_requested_type() -> None:
    assert arguments.numbers([[1, 2], [3, 4]], "speeds").shape == (2, 2)
    assert arguments.numbers([1, 0], "mask", np.bool_).dtype == np.bool_
    assert arguments.numbers(np.arange(10.0)[::2], "speeds").flags.c_contiguous
    assert arguments.numbers([1.0], "speeds", flat=True).tolist() == [1.0]
    assert "(1, 1)" in input_error(arguments.numbers, [[1.0]], "speeds", flat=True).problem


def test_toml_number_is_returned_as_float_and_other_values_are_rejected() -> None:
    given: list[Any] = [1, 2.5, np.float32(0.5), float("inf")]
    assert [number(value, "k") for value in given] == [1.0, 2.5, 0.5, float("inf")]
    for value in (True, "1", [1], 10**400):
        assert input_error(number, value, "k").key == "k"


def test_positive_toml_number_is_rejected_outside_1e_minus_12_to_1e12() -> None:
    assert [positive(value, "k") for value in (1e-12, 1.0, 1e12)] == [1e-12, 1.0, 1e12]
    for value in (0.0, -1, float("inf"), float("nan"), 0.99e-12, 1.01e12):
        assert input_error(positive, value, "k").key == "k"


def test_toml_value_is_rejected_where_a_table_is_required() -> None:
    given = {"a": 1}
    assert table(given, "rig") is given
    assert input_error(table, 3, "rig").key == "rig"


def test_unknown_toml_key_is_reported_with_the_nearest_known_key() -> None:
    refuse_unknown(["a"], iter(["a", "b"]))
    error = input_error(refuse_unknown, ["radius", "x"], iter(["radius_m"]), "bearing.")
    assert error.key == "bearing.radius"
    assert "radius_m" in str(error.remedy)


def test_toml_syntax_error_is_reported_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("a = 1\n[b]\nc = 2.5\n")
    assert read_toml(path) == {"a": 1, "b": {"c": 2.5}}
    for text, row in (("a = 1\nb = \n", 2), ("a = 1\nb", 2), ("a = 1\na = 2\n", 2)):
        path.write_text(text)
        error = input_error(read_toml, path)
        assert (error.file, error.row) == (str(path), row)
