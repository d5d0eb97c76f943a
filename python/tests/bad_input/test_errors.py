"""Error messages, suggestions, and text files that are written completely or not at all."""

import os
import pickle
from pathlib import Path

import pytest
from jbf.errors import InputError, closest, did_you_mean, printable, quoted
from jbf.text_files import read_text, write_text, write_texts


def test_error_message_names_place_problem_and_remedy() -> None:
    place = {"file": "a.csv", "row": 17, "column": "friction_n"}
    error = InputError(**place, problem="is wrong", remedy="correct it")  # type: ignore[arg-type]
    assert str(error) == "a.csv, row 17, column friction_n: is wrong; correct it"
    assert str(InputError(problem="is wrong")) == "is wrong"
    assert str(InputError(key="load", problem="is\n wrong")) == "key load: is wrong"


def test_input_error_gains_file_and_key_prefix_but_keeps_a_known_file() -> None:
    missing = InputError(key="radius_m", problem="is missing")
    error = missing.within(file="rig.toml", key_prefix="bearing.")
    assert (error.file, error.key) == ("rig.toml", "bearing.radius_m")
    assert error.within(file="other.toml").file == "rig.toml"


def test_input_error_is_unchanged_by_pickling() -> None:
    error = InputError(file="a", row=3, column="c", key="k", problem="p", remedy="m")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.row, copy.remedy) == (str(error), 3, "m")


def test_suggestion_ignores_case_and_lists_the_known_words_if_none_is_similar() -> None:
    assert closest("STRIBEK", ["coulomb", "Stribeck"]) == "Stribeck"
    assert closest("xyz", ["coulomb", "stribeck"]) is None
    assert did_you_mean("stribek", ["coulomb", "stribeck"]) == 'did you mean "stribeck"?'
    assert did_you_mean("xyz", ["coulomb", "stribeck"]) == "known: coulomb, stribeck"


def test_quoted_text_escapes_control_characters_and_is_truncated_to_40_characters() -> None:
    assert quoted("a\x1b[31m") == '"a\\x1b[31m"'
    assert quoted("x" * 40) == f'"{"x" * 40}"'
    assert quoted("x" * 41) == f'"{"x" * 37}..."'
    assert printable("a\x07b\nc") == "a\\x07b\nc"


def test_several_files_are_written_together_or_not_at_all(tmp_path: Path) -> None:
    first, second = tmp_path / "first.txt", tmp_path / "no" / "second.txt"
    first.write_text("old")
    before = sorted(os.listdir(tmp_path))
    with pytest.raises(InputError, match="its folder does not exist"):
        write_texts({first: "new", second: "new"})
    assert first.read_text() == "old"
    assert sorted(os.listdir(tmp_path)) == before
    second.parent.mkdir()
    write_texts({first: "new", second: "µ"})
    assert first.read_text() == "new"
    assert second.read_bytes() == "µ".encode()


def test_written_text_is_read_without_its_byte_order_mark(tmp_path: Path) -> None:
    write_text(tmp_path / "a.txt", "\ufeffµ = 1\n")
    assert read_text(tmp_path / "a.txt") == "µ = 1\n"
