"""Checks of what is passed, one by one: what is let through, and each refusal to the letter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf import InputError, Rig, Run
from jbf.records.arguments import (
    by_name,
    check_callable,
    check_run,
    described,
    list_of_runs,
    names,
    numbers,
    of_kind,
    one_of,
    one_run,
    the_rig,
    whole_number,
)
from jbf.records.counts import count_of
from jbf.records.toml_file import (
    number,
    positive,
    read_toml,
    refuse_unknown,
    table,
)

T = np.linspace(0.0, 1.0, 20)
RUN = Run.from_arrays(T, 0.1 + T, np.ones(20), name="sine")


def refusal(ask: Callable[..., Any], *given: Any, **named: Any) -> str:
    """The one line of an error."""
    with pytest.raises(InputError) as caught:
        ask(*given, **named)
    return str(caught.value)


class Under:
    """Of a name with a vowel."""


class elf:
    """With a small one."""


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (None, "None"),
        ("a b", '"a b"'),
        (Path("r") / "a.csv", 'the path "r/a.csv"'),
        ([], "a list"),
        (1, "an int"),
        (1.0, "a float"),
        (Under(), "an Under"),
        (elf(), "an elf"),
        (Rig(), "a Rig"),
    ],
)
def test_a_value_as_an_error_calls_it(value: object, said: str) -> None:
    """Text and paths by themselves, all else by its kind."""
    assert described(value) == said


def test_a_kind_is_let_through_and_another_named() -> None:
    """The very value comes back."""
    assert of_kind(RUN, Run, "the run", "mend") is RUN
    assert refusal(of_kind, 3, Run, "the run", "give one") == "the run is an int; give one"


def test_a_rig_and_a_run_and_what_stands_in_their_place() -> None:
    """A path is to be read, a list to be parted."""
    rig = Rig()
    assert the_rig(rig) is rig
    said = "give a jbf.Rig, first of all (jbf.Rig() for a law in newtons)"
    assert refusal(the_rig, None) == f"the rig is None; {said}"
    assert refusal(the_rig, "r.toml") == 'the rig is "r.toml"; read it: jbf.read_rig("r.toml")'
    assert refusal(the_rig, Path("r")) == 'the rig is the path "r"; read it: jbf.read_rig("r")'
    assert one_run(RUN) is RUN
    assert refusal(one_run, rig) == "the run is a Rig; give a jbf.Run"
    assert refusal(one_run, "a.csv") == 'the run is "a.csv"; read it: jbf.read_run("a.csv")'
    assert refusal(one_run, Path("a")) == 'the run is the path "a"; read it: jbf.read_run("a")'
    for several in ([RUN], (RUN,)):
        assert refusal(one_run, several).endswith("; give one of them")


def test_a_run_that_a_constructor_trusted_is_checked() -> None:
    """Arrays of float64 in one row, none masked; then what their names promise."""
    check_run(RUN)
    said = "make the run with jbf.Run.from_arrays, which converts and checks"
    wrong: tuple[Any, ...] = (
        [1.0] * 20,
        np.ones(20, dtype=np.float32),
        np.ones((20, 1)),
        np.ma.masked_array(np.ones(20), mask=[True] + [False] * 19),
    )
    for values in wrong:
        assert refusal(check_run, replace(RUN, friction_n=values)) == (
            f"sine, column friction_n: is no array of float64, shape (N,); {said}"
        )
    short: Any = [1]
    assert "column velocity_m_s: is no array" in refusal(
        check_run, replace(RUN, velocity_m_s=short)
    )
    unread = replace(RUN, velocity_m_s=short, speed_recorded=False)
    assert "column velocity_m_s" in refusal(check_run, unread)
    broken = np.array([*np.ones(19), np.nan])
    assert refusal(check_run, replace(RUN, friction_n=broken)).startswith(
        "sine, column friction_n: sample 19: nan is not a finite number"
    )


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (RUN, "runs is a single run; write a list of one: [run]"),
        ("a", 'runs is "a"; read them: jbf.read_runs("a")'),
        (Path("a"), 'runs is the path "a"; read them: jbf.read_runs("a")'),
        (Rig(), "runs is a Rig; give the rig first, then the list of runs"),
        (None, "runs is None; give a list of jbf.Run"),
        (3, "runs is an int; give a list of jbf.Run"),
        ({"a": RUN}, "runs is a dict; give a list of jbf.Run"),
        ({}, "runs is a dict; give a list of jbf.Run"),
        ([RUN, "b"], 'runs holds "b" at place 1; read it: jbf.read_run("b")'),
        ([Path("b")], 'runs holds the path "b" at place 0; read it: jbf.read_run("b")'),
        ([RUN, RUN, 3], "runs holds an int at place 2; give a list of jbf.Run"),
    ],
)
def test_what_is_no_list_of_runs(value: object, said: str) -> None:
    """Each with what to do."""
    assert refusal(list_of_runs, value) == said


def test_runs_may_come_in_any_row() -> None:
    """As a list of its own; each of them is checked."""
    given = [RUN, RUN]
    found = list_of_runs(given)
    assert found == given
    assert found is not given
    assert list_of_runs(iter(given)) == list_of_runs((RUN, RUN)) == given
    assert list_of_runs([]) == []
    wrong: Any = [1.0]
    assert "is no array" in refusal(list_of_runs, [RUN, replace(RUN, friction_n=wrong)])


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("a", 'effects is text where a list of names is meant; write effects=["a"]'),
        ("", "effects is text where a list of names is meant; write effects=[]"),
        (None, "effects is None; write a list of names: effects=[]"),
        (3, "effects is an int; write a list of names: effects=[]"),
        (["a", 3], "effects holds an int; write names, in quotes"),
    ],
)
def test_what_is_no_list_of_names(value: object, said: str) -> None:
    """A word that stands alone is none."""
    assert refusal(names, value, "effects") == said
    assert names(iter(["a", "b"]), "effects") == ("a", "b")
    assert names([], "effects") == ()


@pytest.mark.parametrize(("value", "least"), [(0, 0), (3, 3), (np.int64(7), 2), (-1, -1)])
def test_whole_numbers_from_the_least_on(value: Any, least: int) -> None:
    """Of any integer kind, as an int."""
    found = whole_number(value, "n", least)
    assert (found, type(found)) == (int(value), int)


@pytest.mark.parametrize(
    ("value", "least", "said"),
    [
        (-1, 0, "n is -1; give a whole number from 0 on"),
        (2, 3, "n is 2; give a whole number from 3 on"),
        (True, 0, "n is True; give a whole number from 0 on"),
        (1.0, 0, "n is 1.0; give a whole number from 0 on"),
        (Fraction(1, 2), 0, "n is 1/2; give a whole number from 0 on"),
        ("1", 0, 'n is "1"; give a whole number from 0 on'),
        (None, 0, "n is None; give a whole number from 0 on"),
    ],
)
def test_what_is_no_whole_number(value: object, least: int, said: str) -> None:
    """Numbers are shown, other things are named; what is true is no number."""
    assert refusal(whole_number, value, "n", least) == said
    assert refusal(whole_number, -1, "n") == "n is -1; give a whole number from 0 on"


def test_functions_words_and_values_by_name() -> None:
    """Each let through, and each refused."""
    check_callable(None, "progress")
    check_callable(print, "progress")
    assert refusal(check_callable, 3, "progress") == "progress is an int; give a function, or None"
    assert one_of("b", iter(["a", "b"]), "clock") == "b"
    assert refusal(one_of, "journl", ["journal", "thesis"], "clock") == (
        'there is no clock "journl"; did you mean "journal"?'
    )
    assert refusal(one_of, 3, ["a", "b"], "clock") == "the clock is an int; known: a, b"
    given = {"a": 1}
    found = by_name(given, "start")
    assert found == given
    assert found is not given
    mend = 'write them by name: start={"NAME": VALUE}'
    assert refusal(by_name, [1], "start") == f"start is a list; {mend}"
    assert refusal(by_name, {1: 2}, "start") == f"start names an int; {mend}"


def test_arrays_of_numbers() -> None:
    """Contiguous, of the kind that is asked for; flat where that is asked."""
    found = numbers([[1, 2], [3, 4]], "speeds")
    assert found.dtype == np.float64
    assert found.shape == (2, 2)
    assert numbers([1, 0], "mask", np.bool_).dtype == np.bool_
    assert numbers(np.arange(10.0)[::2], "speeds").flags.c_contiguous
    mend = "give numbers, one a sample"
    assert refusal(numbers, None, "speeds") == f"speeds is None; {mend}"
    assert refusal(numbers, ["a"], "speeds") == f"speeds is no array of numbers; {mend}"
    assert refusal(numbers, [[1], [1, 2]], "speeds") == f"speeds is no array of numbers; {mend}"
    assert refusal(numbers, [[1.0]], "speeds", flat=True) == f"speeds has shape (1, 1); {mend}"
    assert numbers([1.0], "speeds", flat=True).tolist() == [1.0]


@pytest.mark.parametrize(("value", "found"), [(1, 1.0), (2.5, 2.5), (np.float32(0.5), 0.5)])
def test_a_number_of_a_file(value: Any, found: float) -> None:
    """As a float; what is true, text and tables are none, nor what no float holds."""
    assert number(value, "k") == found
    assert number(float("inf"), "k") == float("inf")
    mend = "write a plain number"
    assert refusal(number, True, "k") == f"key k: a bool is not a number; {mend}"
    assert refusal(number, "1", "k") == f'key k: "1" is not a number; {mend}'
    assert refusal(number, [1], "k") == f"key k: a list is not a number; {mend}"
    assert refusal(number, 10**400, "k") == "key k: is too large; correct the value"


@pytest.mark.parametrize("value", [1e-12, 1.0, 1e12])
def test_a_size_that_a_machine_may_have(value: float) -> None:
    """From 1e-12 to 1e12, both among them."""
    assert positive(value, "k") == value


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (0.0, "0.0 is not above zero and finite; correct the value"),
        (-1, "-1.0 is not above zero and finite; correct the value"),
        (float("inf"), "inf is not above zero and finite; correct the value"),
        (float("nan"), "nan is not above zero and finite; correct the value"),
        (0.99e-12, "9.9e-13 is beyond what any machine has; give it in SI units"),
        (1.01e12, "1010000000000.0 is beyond what any machine has; give it in SI units"),
    ],
)
def test_a_size_that_no_machine_has(value: float, said: str) -> None:
    """Just beyond either end."""
    assert refusal(positive, value, "k") == f"key k: {said}"


def test_tables_and_keys_that_nobody_knows() -> None:
    """The first such key, after its prefix, with the nearest known one."""
    given = {"a": 1}
    assert table(given, "rig") is given
    assert refusal(table, 3, "rig") == "key rig: is not a table; write it as [rig] with keys"
    refuse_unknown(["a"], iter(["a", "b"]))
    assert refusal(refuse_unknown, ["radius", "x"], iter(["radius_m"]), "bearing.") == (
        'key bearing.radius: is not known; did you mean "radius_m"?'
    )


def test_a_file_that_is_no_toml_is_told_by_its_line(tmp_path: Path) -> None:
    """And in words without tomlkit's own places."""
    path = tmp_path / "a.toml"
    path.write_text("a = 1\n[b]\nc = 2.5\n")
    found = read_toml(path)
    assert found == {"a": 1, "b": {"c": 2.5}}
    assert type(found) is type(found["b"]) is dict
    mend = "correct it; TOML is written key = value, each key once"
    for text, row, reason in (
        ("a = 1\nb = \n", 2, "unexpected character: '\\n'"),
        ("a = 1\nb", 2, "unexpected end"),
    ):
        path.write_text(text)
        said = refusal(read_toml, path)
        assert said.startswith(f"{path}, row {row}: is not TOML (")
        assert said.endswith(f"); {mend}")
        assert " at line " not in said
        assert reason.split()[0] in said
    path.write_text("a = 1\na = 2\n")
    assert f"{path}" in refusal(read_toml, path)
    assert refusal(read_toml, path).endswith(mend)


def test_one_and_several() -> None:
    """A plural of its own where one is given."""
    assert [count_of(n, "run") for n in (0, 1, 2)] == ["0 runs", "1 run", "2 runs"]
    assert [count_of(n, "entry", "entries") for n in (1, 3)] == ["1 entry", "3 entries"]
