"""Parts that pages and files share: JSON, paragraphs, pictures within a page, provenance."""

from __future__ import annotations

import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from by_hand import coulomb, one_way
from jbf import Run
from jbf.errors import InputError
from jbf.plot.style import BEFORE, INK, MEASURED, MODEL, NOISE, OTHER
from jbf.reporting.advice import ADVICE, NONE, advice_on
from jbf.reporting.json import json_text
from jbf.reporting.page import PACKAGES, page
from jbf.reporting.paragraphs import WIDTH, columns, hanging
from jbf.reporting.provenance import file_rows, fingerprint
from jbf.reporting.svg import svg
from matplotlib.figure import Figure


@pytest.mark.parametrize(
    ("value", "read"),
    [
        (float("nan"), None),
        (float("inf"), "inf"),
        (-float("inf"), "-inf"),
        (1.5, 1.5),
        (True, True),
        (None, None),
        ("é", "é"),
        ((1, 2.5), [1, 2.5]),
        ({1: {"a": (np.float64(2.0), np.nan)}}, {"1": {"a": [2.0, None]}}),
        (np.array([[1.0, -np.inf], [np.nan, 2.0]]), [[1.0, "-inf"], [None, 2.0]]),
        (np.int64(3), 3),
        (np.bool_(True), True),
    ],
)
def test_numbers_that_json_has_not_are_null_or_words(value: Any, read: Any) -> None:
    """All else as it is, arrays as lists; one line feed at the end."""
    text = json_text(value)
    assert json.loads(text) == read
    assert text.endswith("\n")
    assert not text.endswith("\n\n")


def test_json_is_indented_by_one_and_letters_stay_letters() -> None:
    """People read it, too."""
    assert json_text({"ü": [1, 2]}) == '{\n "ü": [\n  1,\n  2\n ]\n}\n'


def test_cells_stand_below_each_other_on_their_side() -> None:
    """Two spaces between columns, as many before them as asked for, none at the end."""
    rows = [("a", "1", "x"), ("bbb", "22", ""), ("", "3", "yyyy")]
    assert columns(rows, "<>>") == [
        "  a     1     x",
        "  bbb  22",
        "        3  yyyy",
    ]
    assert columns([("a", "b")], "><", 0) == ["a  b"]
    assert columns([("a", "b")], "><", 3) == ["   a  b"]


def test_further_lines_hang_below_the_text() -> None:
    """No line is longer than the width; a lead without text stands alone."""
    words = " ".join(["word"] * 40)
    lines = hanging("lead: ", words, 4)
    assert lines[0].startswith("    lead: word")
    assert all(line.startswith(" " * 10 + "word") for line in lines[1:])
    assert " ".join(" ".join(lines).split()) == f"lead: {words}"
    assert WIDTH - 5 < max(map(len, lines)) <= WIDTH == 92
    assert hanging("lead: ", "", 4) == ["    lead:"]
    assert hanging("- ", "x") == ["  - x"]


@pytest.mark.parametrize("together", ["v < 0", "v >= 0.25 m/s", "0.25 N", "3 N m", "10 deg", "2 s"])
def test_a_number_and_its_unit_stay_on_one_line(together: str) -> None:
    """Wherever the line would break."""
    for filling in range(60, 95):
        lines = hanging("", f"{'x' * filling} {together} y", 0)
        assert any(together in line for line in lines)
        assert "\0" not in "".join(lines)


def drawing(colours: tuple[str, ...]) -> str:
    """Lines of these colours as a page holds them."""
    ax = Figure(figsize=(2.0, 1.0)).subplots()
    for i, colour in enumerate(colours):
        ax.plot([0, 1], [i, i], color=colour)
    ax.set_title("A <title>")
    return str(svg([ax], 'two & "more"'))


def test_the_pages_colours_are_the_pages_and_others_stay() -> None:
    """Every named colour is a variable; text is text in the page's face."""
    named = {MODEL: "model", BEFORE: "before", NOISE: "noise", MEASURED: "measured",
             OTHER: "other", INK: "ink"}  # fmt: skip
    text = drawing((*named, "#123456"))
    for colour, name in named.items():
        assert f"var(--{name})" in text
        assert colour not in text
    assert "#123456" in text
    assert re.search(r"font[^;\"]*var\(--face\)", text)
    assert "A &lt;title&gt;</text>" in text


def test_a_picture_in_a_page_is_as_wide_as_its_place_and_the_same_twice() -> None:
    """Neither width nor date; its box is that of the figure in points; its words are escaped."""
    text = drawing((MODEL,))
    assert text == drawing((MODEL,))
    head = text.partition(">")[0]
    assert text.startswith("<svg ")
    assert 'viewBox="0 0 144 72"' in head
    assert "width" not in head
    assert "height" not in head
    assert 'class="figure" role="img" aria-label="two &amp; &quot;more&quot;"' in head
    assert text.count("<svg") == 1
    assert "<dc:date>" not in text


def test_a_page_says_what_made_it_and_escapes_what_it_is_given() -> None:
    """Versions of the packages; the command only where there is one."""
    text = page("text.html.j2", "A <title>", command="jbf <x>", words="1 < 2", picture="")
    assert "A &lt;title&gt;" in text
    assert "jbf &lt;x&gt;" in text
    assert "1 &lt; 2" in text
    assert all(name in text for name in PACKAGES)
    assert re.search(r"\d{4}-\d\d-\d\d \d\d:\d\d UTC", text)
    assert "Made by" not in page("text.html.j2", "t", words="", picture="")


def run_of(name: str, more: float = 0.0) -> Run:
    return one_way(name, lambda t, v, a: coulomb(t, v, a) + more, duration_s=1.0)


def test_a_fingerprint_is_of_names_and_samples_in_their_order() -> None:
    """SHA-256 over each run's name, its columns' names and their numbers as little-endian."""
    run, other = run_of("a"), run_of("b")
    digest = hashlib.sha256(b"a")
    for name, values in run.columns().items():
        digest.update(name.encode() + values.astype("<f8").tobytes())
    assert fingerprint([run]) == digest.hexdigest()
    seen = [fingerprint(r) for r in ([run, other], [other, run], [run], [run_of("a", 1e-9)], [])]
    assert len(set(seen)) == len(seen)


def test_files_are_told_with_the_begin_of_their_hash(tmp_path: Path) -> None:
    """Sixteen digits; a run of no file has no row, one whose file went says so."""
    path = tmp_path / "a.csv"
    path.write_text("words")
    runs = [run_of("x"), Run(**{**vars(run_of("y")), "path": path}), run_of("z")]
    whole = hashlib.sha256(b"words").hexdigest()
    assert file_rows(runs) == [("y", str(path), whole[:16])]
    path.unlink()
    assert file_rows(runs) == [("y", str(path), "no longer there")]


def test_what_has_no_advice_of_its_own_has_the_general_one() -> None:
    """Every other axis has its own."""
    assert advice_on("nothing known") is NONE
    assert all(advice_on(axis) is advice for axis, advice in ADVICE.items())
    with pytest.raises(AttributeError):
        NONE.causes = "other"  # type: ignore[misc]


def test_a_picture_of_no_kind_is_refused(tmp_path: Path) -> None:
    """By the end of its name, or by its folder."""
    from jbf.plot.style import save

    ax = Figure().subplots()
    for path in (tmp_path / "a.words", tmp_path / "none" / "a.svg"):
        with pytest.raises(InputError, match="cannot be written"):
            save(ax, path)
