"""The picture of an import: what is shaded, in which colour, where, and what is named."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jbf.errors import InputError
from jbf.importing.cutting.piece import Piece
from jbf.importing.overview import Overview
from jbf.importing.result import Import
from jbf.plot.style import BEFORE, MEASURED, MODEL
from jbf.records.rig import Rig
from jbf.reporting.cut_plot import import_page, plot_cut, save_cut
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

CHANNEL: dict[str, Any] = {
    "channel": "time_s",
    "made_of": "t",
    "read": [],
    "unit": "s",
    "rate_hz": None,
    "clock": "own",
}
CURVE = (np.arange(4.0), np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 2.0, 4.0, 7.0]))


def imported(pieces: Sequence[Piece], *views: Overview) -> Import:
    """Pieces of recordings that are seen so."""
    there = views or (Overview("a.csv", (0.0, 100.0), {"friction_n": CURVE}),)
    return Import(Path("out"), Rig(), tuple(pieces), {"files": []}, there)


def spans(ax: Axes) -> list[tuple[float, float, str]]:
    """Begin, end and colour of what is shaded, `///` of what is left out."""
    found = []
    for patch in ax.patches:
        box: Any = patch
        colour = box.get_hatch() or to_hex(box.get_facecolor())
        found.append((box.get_x(), box.get_x() + box.get_width(), colour))
    return found


def test_each_curve_of_each_recording_has_axes_of_its_own() -> None:
    """Filled from the least to the largest, a line in the middle; titled by file and column."""
    two = {"friction_n": CURVE, "velocity_m_s": CURVE}
    views = Overview("a.csv", (0.0,), two), Overview("b.csv", (0.0,), {"load_n": CURVE})
    axes = plot_cut(imported([], *views))
    assert [ax.get_title(loc="left") for ax in axes] == [
        "a.csv: friction_n", "a.csv: velocity_m_s", "b.csv: load_n"
    ]  # fmt: skip
    assert [(ax.get_xlabel(), ax.get_ylabel()) for ax in axes][1:] == [
        ("Time (s)", "velocity_m_s"), ("Time (s)", "load_n")
    ]  # fmt: skip
    for ax in axes:
        (line,), (filled,) = ax.lines, ax.collections
        times, middle = line.get_xydata().T  # type: ignore[union-attr]
        assert middle.tolist() == [0.5, 1.5, 3.0, 5.0]
        assert times.tolist() == [0.0, 1.0, 2.0, 3.0]
        box = filled.get_paths()[0].get_extents()
        assert (box.y0, box.y1) == (0.0, 7.0)
        colour: Any = filled.get_facecolor()
        assert to_hex(colour[0]) == MEASURED
    width, height = axes[0].figure.get_size_inches()  # type: ignore[union-attr]
    assert (width, height) == pytest.approx((11.0, 0.8 + 3 * 1.7))


def test_runs_are_shaded_in_turn_and_what_is_left_out_is_hatched() -> None:
    """Where they are in the picture: a stretch of time stands behind the one before."""
    pieces = [
        Piece("a_1", "a.csv", 0, 1.0, 2.0),
        Piece("", "a.csv", 0, 2.0, 4.0, False, "at rest"),
        Piece("a_2", "a.csv", 1, 5.0, 6.0),
        Piece("b_1", "b.csv", 0, 7.0, 8.0),
        Piece("a_3", "a.csv", 1, 6.0, 9.0),
    ]
    (ax,) = plot_cut(imported(pieces))
    assert spans(ax) == [
        (1.0, 2.0, MODEL),
        (2.0, 4.0, "///"),
        (105.0, 106.0, BEFORE),
        (106.0, 109.0, MODEL),
    ]
    named = [(text.get_text(), text.xy) for text in ax.texts]  # type: ignore[attr-defined]
    assert named == [("1", (1.0, 1.0)), ("2", (105.0, 1.0)), ("3", (106.0, 1.0))]


def test_a_name_is_no_formula() -> None:
    """Of a run alone all of its name, whatever is in it."""
    (ax,) = plot_cut(imported([Piece("a_$x^2$", "a.csv", 0, 1.0, 2.0)]))
    assert [text.get_text() for text in ax.texts] == [r"a_\$x^2\$"]


@pytest.mark.parametrize(("count", "named"), [(40, 40), (41, 0)])
def test_more_than_forty_runs_have_no_names(count: int, named: int) -> None:
    """There would be no room for them; they are shaded all the same."""
    (ax,) = plot_cut(imported([Piece(f"r_{k}", "a.csv", 0, k, k + 0.5) for k in range(count)]))
    assert (len(ax.patches), len(ax.texts)) == (count, named)


def test_axes_may_be_given_and_must_be_enough(tmp_path: Path) -> None:
    """What is given is drawn on; a picture is written, or refused by the end of its name."""
    found = imported([Piece("r", "a.csv", 0, 1.0, 2.0)])
    drawn = plot_cut(found)
    assert plot_cut(found, drawn) == drawn
    with pytest.raises(InputError, match="2 axes were given"):
        plot_cut(found, [*drawn, *drawn])
    save_cut(found, tmp_path / "cut.svg")
    assert "<svg" in (tmp_path / "cut.svg").read_text()
    with pytest.raises(InputError, match=r"name a \.png"):
        save_cut(found, tmp_path / "cut.words")


def test_the_page_holds_the_picture_and_the_words() -> None:
    """The same words as the summary's."""
    ledger = {"file": "a.csv", "channels": [CHANNEL], "dropped": [], "notes": ["of a note"]}
    found = imported([Piece("r", "a.csv", 0, 1.0, 2.0)])
    told = Import(found.folder, found.rig, found.pieces, {"files": [ledger]}, found.overviews)
    page = import_page(told)
    assert "1 run of 1 s in all, from 1 file:" in page
    assert "a.csv: of a note" in page
    assert 'aria-label="Each recording in time, and how it was cut"' in page
